// SPDX-License-Identifier: GPL-3.0-or-later
// The command `info`: describes a session.
#include <stdlib.h>
#include <string.h>

#include "cautery/commands.h"
#include "cautery/words.h"

static void print_layers(const cli *c, const cau_wire_session_description *d)
{
	const cau_wire_layer_description *layers = d->layers.items;
	for (int32_t i = 0; i < d->layers.count; i++)
		fprintf(c->out, "  layer %-16s %-9s %lld elements, %lld faces\n", layers[i].name,
		        cli_layer_word(layers[i].kind), (long long)layers[i].element_count,
		        (long long)layers[i].face_count);
}

static void print_drivers(const cli *c, const cau_wire_session_description *d)
{
	const cau_wire_driver *drivers = d->drivers.items;
	for (int32_t i = 0; i < d->drivers.count; i++) {
		fprintf(c->out, "  tool %-17s ", drivers[i].tool);
		if (drivers[i].client)
			fprintf(c->out, "driven by %s (client %lld)", drivers[i].name,
			        (long long)drivers[i].client);
		else
			fputs("no driver", c->out);
		if (drivers[i].energized)
			fputs(", energy on\n", c->out);
		else
			fprintf(c->out, ", energy off (%s)\n", cli_energy_off_word(drivers[i].energy_off));
	}
}

static void print_description(const cli *c, const cau_wire_session_description *d)
{
	const cau_wire_session_summary *s = &d->summary;
	fprintf(c->out, "%s: scene %s, %s\n", s->session, s->scene, cli_state_word(s->state));
	if (*d->description)
		fprintf(c->out, "  %s\n", d->description);
	fprintf(c->out, "  tick %lld, %.2f s simulated, one tick %.4g s, rate %.3f of %g\n",
	        (long long)s->tick, s->time_s, s->step_s, s->realtime_factor, s->speed);
	fprintf(c->out, "  %lld vertices, %lld triangles, %lld tetrahedra, %lld links, %lld faces\n",
	        (long long)s->vertex_count, (long long)d->triangle_count,
	        (long long)d->tetrahedron_count, (long long)d->link_count, (long long)s->face_count);
	print_layers(c, d);
	print_drivers(c, d);
	fprintf(c->out, "  %lld streams, instruction set %s, epoch %016llx\n",
	        (long long)s->subscriber_count, d->instruction_set, (unsigned long long)s->epoch);
	if (s->has_fault)
		fprintf(c->out, "  faulted: %s\n", s->fault);
}

static cli_exit run(cli *c)
{
	cau_wire_layer_description layers[CAU_MAX_LAYERS];
	cau_wire_driver drivers[CAU_MAX_TOOLS];
	cau_wire_session_ref params = {0};
	cau_wire_session_description d = {.layers = {layers, 0, CAU_MAX_LAYERS},
	                                  .drivers = {drivers, 0, CAU_MAX_TOOLS}};
	cli_exit code = cli_connect(c);
	d.definition = calloc(1, sizeof *d.definition);
	CLI_SESSION_PARAMS(c, &params);
	if (!code)
		code = d.definition ? cli_call(c, CAU_METHOD_SESSION_DESCRIBE, &params, &d)
		                    : cli_fail_memory(c);
	if (!code && !c->json)
		print_description(c, &d);
	free(d.definition);
	return code;
}

const cli_command cli_info = {.name = "info",
                              .arguments = "[SESSION]",
                              .summary = "describes the tissue, tools and drivers of a session",
                              .help = "With --json the output also has the whole scene, with its "
                                      "present materials and tools.\n",
                              .session_optional = true,
                              .run = run};

// SPDX-License-Identifier: GPL-3.0-or-later
// The commands `ls`, `scenes`, `instruments`, `info` and `rm`.
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"
#include "cautery/instrument.h"
#include "cautery/name.h"

enum { SESSIONS_MAX = 65536, SCENES_MAX = 256, INSTRUMENTS_MAX = 64 };

static void print_sessions(const cli *c, const cau_wire_list *list)
{
	const cau_wire_session_summary *all = list->items;
	fprintf(c->out, "%-24s %-18s %-8s %9s %9s %6s %8s %8s %5s %7s\n", "SESSION", "SCENE", "STATE",
	        "TICK", "TIME", "RATE", "VERTICES", "FACES", "TOOLS", "STREAMS");
	for (int32_t i = 0; i < list->count; i++)
		fprintf(c->out, "%-24s %-18s %-8s %9lld %7.2f s %6.3f %8lld %8lld %5lld %7lld\n",
		        all[i].session, all[i].scene, cli_state_word(all[i].state), (long long)all[i].tick,
		        all[i].time_s, all[i].realtime_factor, (long long)all[i].vertex_count,
		        (long long)all[i].face_count, (long long)all[i].tool_count,
		        (long long)all[i].subscriber_count);
}

static int by_id(const void *a, const void *b)
{
	const cau_wire_session_summary *left = a, *right = b;
	return strcmp(left->session, right->session);
}

// Adds the sessions of the connected daemon to the list.
static cli_exit add_sessions(cli *c, cau_wire_list *all)
{
	cau_wire_session_summary *first = all->items;
	cau_wire_session_list more = {.sessions = {first + all->count, 0, all->capacity - all->count}};
	if (cau_client_call(c->client, CAU_METHOD_SESSION_LIST, &(cau_wire_nothing){0}, &more,
	                    &c->error))
		return cli_fail(c);
	all->count += more.sessions.count;
	return CLI_DONE;
}

// Adds the sessions of the daemons of all labels in the list `labels`, such as "d1,d2". A
// connection through a proxy serves one of these daemons.
static cli_exit gather_named(cli *c, const char *labels, cau_wire_list *all)
{
	char label[CAU_NAME_BYTES];
	for (const char *at = labels; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
		int length = snprintf(label, sizeof label, "%.*s", (int)strcspn(at, ","), at);
		if (length == 0 || length >= CAU_NAME_BYTES || !cau_name_is_valid(label)) {
			cli_complain(c, "--label: \"%.*s\" is not a label", (int)strcspn(at, ","), at);
			return CLI_USAGE;
		}
		cli_exit code = cli_connect_to(c, NULL, label);
		if (!code)
			code = add_sessions(c, all);
		if (code)
			return code;
	}
	return CLI_DONE;
}

// Adds the sessions of all daemons that the proxy lists. If a daemon does not answer, the other
// sessions are still listed. The failure is printed, and the exit code says that the list is
// incomplete.
static cli_exit gather_fleet(cli *c, const cau_fleet *fleet, cau_wire_list *all)
{
	cli_exit worst = CLI_DONE;
	for (int32_t i = 0; i < fleet->count; i++) {
		cli_exit code = cli_connect_to(c, NULL, fleet->labels[i]);
		if (!code)
			code = add_sessions(c, all);
		if (code)
			cli_complain(c, "the sessions of %s are not in the list", fleet->labels[i]);
		worst = code ? code : worst;
	}
	return worst;
}

static cli_exit gather_all(cli *c, cau_wire_list *all)
{
	cau_fleet *fleet = malloc(sizeof *fleet);
	if (!fleet)
		return cli_fail_memory(c);
	cli_exit code = cli_find_fleet(c, fleet);
	if (!code && fleet->count > 0) {
		code = gather_fleet(c, fleet, all);
	} else if (!code) {
		code = cli_connect_to(c, NULL, NULL);
		code = code ? code : add_sessions(c, all);
	}
	free(fleet);
	return code;
}

static cli_exit run_ls(cli *c)
{
	cau_wire_session_list list = {
		.sessions = {calloc(SESSIONS_MAX, sizeof(cau_wire_session_summary)), 0, SESSIONS_MAX}};
	if (!list.sessions.items)
		return cli_fail_memory(c);
	cli_exit code =
		c->label ? gather_named(c, c->label, &list.sessions) : gather_all(c, &list.sessions);
	qsort(list.sessions.items, (size_t)list.sessions.count, sizeof(cau_wire_session_summary),
	      by_id);
	bool some = !code || list.sessions.count > 0;
	if (some && c->json)
		cli_print_result(c, CAU_METHOD_SESSION_LIST, &list);
	else if (some)
		print_sessions(c, &list.sessions);
	free(list.sessions.items);
	return code;
}

static cli_exit run_scenes(cli *c)
{
	cau_wire_scene_summary all[SCENES_MAX];
	cau_wire_scene_list list = {.scenes = {all, 0, SCENES_MAX}};
	cli_exit code = cli_connect(c);
	if (!code)
		code = cli_call(c, CAU_METHOD_SCENE_LIST, &(cau_wire_nothing){0}, &list);
	for (int32_t i = 0; !code && !c->json && i < list.scenes.count; i++)
		fprintf(c->out, "%-20s %s\n", all[i].name, all[i].description);
	return code;
}

static cli_exit run_instruments(cli *c)
{
	static cau_wire_instrument all[INSTRUMENTS_MAX];
	static cau_wire_instrument_mode modes[INSTRUMENTS_MAX][CAU_MAX_MODES];
	cau_wire_instrument_list list = {.instruments = {all, 0, INSTRUMENTS_MAX}};
	for (int i = 0; i < INSTRUMENTS_MAX; i++)
		all[i].modes = (cau_wire_list){modes[i], 0, CAU_MAX_MODES};
	cli_exit code = cli_connect(c);
	if (!code)
		code = cli_call(c, CAU_METHOD_INSTRUMENT_LIST, &(cau_wire_nothing){0}, &list);
	if (code || c->json)
		return code;
	fprintf(c->out, "%-18s %-12s %8s %12s %7s %6s %6s\n", "INSTRUMENT", "MODE", "POWER", "RANGE",
	        "PEAK", "CREST", "MOST");
	for (int32_t i = 0; i < list.instruments.count; i++)
		for (int32_t m = 0; m < all[i].modes.count; m++) {
			const cau_wire_instrument_mode *mode = &modes[i][m];
			fprintf(c->out, "%-18s %-12s %6.4g W %4.4g to %3.4g W %5.4g V %6.3g %4.2g A\n",
			        all[i].name, mode->mode, mode->power_w, mode->power_least_w, mode->power_most_w,
			        mode->peak_v, mode->crest_factor, mode->current_max_a);
		}
	return CLI_DONE;
}

static bool same_label(const char *a, const char *b)
{
	size_t length = strcspn(a, "-");
	return length == strcspn(b, "-") && strncmp(a, b, length) == 0;
}

static cli_exit run_rm(cli *c)
{
	cli_exit code = CLI_DONE;
	for (int i = 0; !code && i < c->argument_count; i++) {
		if (i == 0 || !same_label(c->arguments[i - 1], c->arguments[i]))
			code = cli_connect_to(c, c->arguments[i], c->label);
		if (code)
			break;
		cau_wire_session_change params = {.has_session = true, .has_client_sequence = true};
		snprintf(params.session, sizeof params.session, "%s", c->arguments[i]);
		params.client_sequence = cau_client_next_sequence(c->client);
		code = cli_call(c, CAU_METHOD_SESSION_DESTROY, &params, NULL);
		if (!code && !c->json)
			fprintf(c->out, "session %s was destroyed\n", c->arguments[i]);
	}
	return code;
}

const cli_command cli_ls = {
	.name = "ls",
	.arguments = "",
	.summary = "lists the sessions",
	.help =
		"RATE is simulated time over wall time in the last second. Behind a proxy, the list has\n"
		"the sessions of all daemons, or with --label d1,d2 of the named daemons.\n",
	.run = run_ls};

const cli_command cli_scenes = {.name = "scenes",
                                .arguments = "",
                                .summary = "lists the scenes from which sessions can be created",
                                .run = run_scenes};

const cli_command cli_instruments = {
	.name = "instruments",
	.arguments = "",
	.summary = "lists the instruments for tools, and the settings of their modes",
	.help =
		"`cautery tool` takes them with --instrument and --mode, a scene's tool with its members\n"
		"instrument and mode. Where the numbers come from is in deploy/instruments.\n",
	.run = run_instruments};

const cli_command cli_rm = {.name = "rm",
                            .arguments = "SESSION...",
                            .summary =
                                "destroys sessions: ends them and removes them from the store",
                            .least = 1,
                            .most = CLI_ARGUMENTS_MAX,
                            .run = run_rm};

// ---- info --------------------------------------------------------------------------------------
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

static cli_exit run_info(cli *c)
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
                              .run = run_info};

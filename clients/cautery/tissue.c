// SPDX-License-Identifier: GPL-3.0-or-later
// The commands `pin`, `unpin`, `force` and `gravity`: forces and constraints on the tissue besides
// its tools.
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"
#include "cautery/defaults.h"

cli_exit cli_command_session(cli *c, const cau_command *command, const char *done)
{
	cau_wire_command_result result = {0};
	if (cau_client_command(c->client, c->session, command, &result, &c->error))
		return cli_fail(c);
	if (c->json) // All commands have the same type of result.
		cli_print_result(c, CAU_METHOD_TOOL_MOVE, &result);
	else
		fprintf(c->out, "%s: %s from tick %lld on\n", c->session, done, (long long)result.tick);
	return CLI_DONE;
}

// Reads the last three arguments. A session may precede them.
static bool read_vector(cli *c, const char *what, double most, double vector[3])
{
	for (int a = 0; a < 3; a++)
		if (!cli_read_number(c, what, c->arguments[c->argument_count - 3 + a], -most, most,
		                     &vector[a]))
			return false;
	return true;
}

// ---- which vertices -----------------------------------------------------------------------------
// Reads numbers that commas separate. Returns false if the option's value is wrong.
static bool read_list(const cli *c, const char *option, int count, double *values)
{
	const char *text = cli_value(c, option);
	for (int i = 0; i < count; i++) {
		char *end;
		values[i] = strtod(text, &end);
		if (end == text || *end != (i + 1 < count ? ',' : 0)) {
			cli_complain(c, "--%s needs %d numbers with commas between, not \"%s\"", option, count,
			             cli_value(c, option));
			return false;
		}
		text = end + 1;
	}
	return true;
}

#define SELECTION_OPTIONS                                                                          \
	{"box", "X,Y,Z,X,Y,Z", "vertices in a box, given by its least and its largest corner, m"},     \
		{"sphere", "X,Y,Z,R", "vertices within R of a point, m"},                                  \
		{"nearest", "X,Y,Z", "the one vertex nearest to a point, m"},                              \
		{"rim", NULL, "vertices on the rim of a sheet, which --layer names"},                      \
	{                                                                                              \
		"layer", "L", "only vertices of layer L"                                                   \
	}

static bool read_selection(const cli *c, cau_selection *selection)
{
	double v[6] = {0};
	const char *layer = cli_value(c, "layer");
	bool box = cli_value(c, "box"), sphere = cli_value(c, "sphere");
	bool nearest = cli_value(c, "nearest"), rim = cli_value(c, "rim");
	if (box + sphere + nearest + rim != 1) {
		cli_complain(c, "choose the vertices with one of --box, --sphere, --nearest and --rim");
		return false;
	}
	*selection = (cau_selection){.kind = box      ? CAU_SELECT_BOX
	                                     : sphere ? CAU_SELECT_SPHERE
	                                     : rim    ? CAU_SELECT_RIM
	                                              : CAU_SELECT_NEAREST};
	snprintf(selection->layer, sizeof selection->layer, "%s", layer ? layer : "");
	if ((box && !read_list(c, "box", 6, v)) || (sphere && !read_list(c, "sphere", 4, v)) ||
	    (nearest && !read_list(c, "nearest", 3, v)))
		return false;
	memcpy(box ? selection->least_m : selection->center_m, v, 3 * sizeof *v);
	if (box)
		memcpy(selection->most_m, v + 3, 3 * sizeof *v);
	selection->radius_m = sphere ? v[3] : 0;
	return true;
}

// ---- the commands -------------------------------------------------------------------------------
static cli_exit run_selected(cli *c, int kind, const char *done)
{
	cau_command command;
	cau_default_command(&command, kind);
	cli_exit code = read_selection(c, &command.as.selection) ? cli_connect(c) : CLI_USAGE;
	return code ? code : cli_command_session(c, &command, done);
}

static cli_exit run_pin(cli *c)
{
	return run_selected(c, CAU_COMMAND_PIN, "held");
}

static cli_exit run_unpin(cli *c)
{
	return run_selected(c, CAU_COMMAND_UNPIN, "free");
}

static cli_exit run_force(cli *c)
{
	cau_command command;
	cau_default_command(&command, CAU_COMMAND_SET_FORCE);
	bool read = read_vector(c, "FORCE", 1e4, command.as.force.force_n) &&
	            read_selection(c, &command.as.force.selection);
	cli_exit code = read ? cli_connect(c) : CLI_USAGE;
	return code ? code : cli_command_session(c, &command, "pulled");
}

static cli_exit run_gravity(cli *c)
{
	cau_command command;
	cau_default_command(&command, CAU_COMMAND_SET_GRAVITY);
	bool read = read_vector(c, "GRAVITY", 100, command.as.gravity_m_s2);
	cli_exit code = read ? cli_connect(c) : CLI_USAGE;
	return code ? code : cli_command_session(c, &command, "gravity was changed");
}

const cli_command cli_pin = {.name = "pin",
                             .arguments = "[SESSION]",
                             .summary = "pins vertices at their present positions",
                             .session_optional = true,
                             .options = {SELECTION_OPTIONS},
                             .run = run_pin};

const cli_command cli_unpin = {.name = "unpin",
                               .arguments = "[SESSION]",
                               .summary = "releases pinned vertices",
                               .session_optional = true,
                               .options = {SELECTION_OPTIONS},
                               .run = run_unpin};

const cli_command cli_force = {.name = "force",
                               .arguments = "[SESSION] FX FY FZ",
                               .summary =
                                   "applies a force to vertices, N on each; 0 0 0 ends the force",
                               .least = 3,
                               .most = 3,
                               .session_optional = true,
                               .options = {SELECTION_OPTIONS},
                               .run = run_force};

const cli_command cli_gravity = {.name = "gravity",
                                 .arguments = "[SESSION] GX GY GZ",
                                 .summary = "sets the gravity of a session, m/s^2",
                                 .least = 3,
                                 .most = 3,
                                 .session_optional = true,
                                 .run = run_gravity};

// SPDX-License-Identifier: GPL-3.0-or-later
// The command `tool` performs a few actions with one tool, one after the other. The first functions
// are for all commands that drive tools.
#include <math.h>
#include <string.h>

#include "cautery/cli.h"
#include "cautery/defaults.h"
#include "cautery/instrument.h"
#include "cautery/name.h"

// ---- driving a tool ----------------------------------------------------------------------------
cli_exit cli_join_tools(cli *c, cau_client_stream **stream)
{
	cau_wire_session_join join = {
		.has_rate_hz = true,
		.rate_hz = 60,
		.has_channels = true,
		.channels = CAU_CHANNEL_MASK | CAU_CHANNEL_TOOLS | CAU_CHANNEL_STATISTICS,
	};
	CLI_SESSION_PARAMS(c, &join);
	return cau_client_join(c->client, &join, stream, &c->error) ? cli_fail(c) : CLI_DONE;
}

const cau_stream_tool *cli_find_tool(const cau_client_stream *stream, const char *tool)
{
	for (int32_t i = 0; i < stream->state->tool_count; i++)
		if (strcmp(stream->state->tools[i].name, tool) == 0)
			return &stream->state->tools[i];
	return NULL;
}

cli_exit cli_take(cli *c, const cau_client_stream *stream, const char *tool)
{
	cau_wire_tool_ref params = {0};
	const cau_stream_tool *found = cli_find_tool(stream, tool);
	if (!found || found->driver == (uint32_t)cau_client_server(c->client)->client)
		return CLI_DONE;
	snprintf(params.tool, sizeof params.tool, "%s", tool);
	CLI_CHANGE_PARAMS(c, &params);
	return cau_client_call(c->client, CAU_METHOD_TOOL_TAKE_OVER, &params, NULL, &c->error)
	           ? cli_fail(c)
	           : CLI_DONE;
}

// ---- the hand of the command -------------------------------------------------------------------
static const double move_every_s = 1.0 / 60;

typedef struct hand {
	cli *c;
	cau_client_stream *stream;
	const char *tool;
	cau_pose pose; // last commanded pose
	double jaw;
	int at; // index of the next argument
	int64_t sequence;
} hand;

static cau_command command_of(hand *h, int kind)
{
	cau_command command;
	cau_default_command(&command, kind);
	snprintf(command.tool, sizeof command.tool, "%s", h->tool);
	command.sequence = (uint64_t)++h->sequence;
	return command;
}

static cli_exit send(hand *h, const cau_command *command, const char *what)
{
	cli *c = h->c;
	cau_wire_command_result result = {0};
	if (cau_client_command(c->client, c->session, command, &result, &c->error))
		return cli_fail(c);
	if (c->json)
		cli_print_result(c, CAU_METHOD_TOOL_MOVE, &result);
	else
		fprintf(c->out, "tick %lld: %s\n", (long long)result.tick, what);
	return CLI_DONE;
}

static bool take_numbers(hand *h, const char *what, int count, double *values)
{
	for (int i = 0; i < count; i++, h->at++) {
		if (h->at >= h->c->argument_count) {
			cli_complain(h->c, "%s needs %d numbers", what, count);
			return false;
		}
		if (!cli_read_number(h->c, what, h->c->arguments[h->at], -1e6, 1e6, &values[i]))
			return false;
	}
	return true;
}

static cli_exit send_pose(hand *h, const char *what)
{
	cau_command command = command_of(h, CAU_COMMAND_TOOL_MOVE);
	command.as.move.pose = h->pose;
	command.as.move.jaw = h->jaw;
	return send(h, &command, what);
}

// ---- actions -----------------------------------------------------------------------------------
// Reads the instrument from --instrument, --mode and --power-w.
static bool take_instrument(hand *h, cau_tool_def *tool)
{
	cau_error error = {0};
	const char *instrument = cli_value(h->c, "instrument"), *mode = cli_value(h->c, "mode");
	const char *power = cli_value(h->c, "power-w");
	double power_w = -1;
	if (power && !cli_read_number(h->c, "--power-w", power, 0, 400, &power_w))
		return false;
	if (!cau_instrument_take(instrument, mode, power_w, tool, &error))
		return true;
	cli_complain(h->c, "%s: %s", error.path, error.reason);
	return false;
}

static cli_exit act_configure(hand *h)
{
	cau_command command = command_of(h, CAU_COMMAND_TOOL_CONFIGURE);
	if (!cli_value(h->c, "instrument")) {
		cli_complain(h->c,
		             "configure needs --instrument: `cautery instruments` lists the instruments");
		return CLI_USAGE;
	}
	if (!take_instrument(h, &command.as.definition))
		return CLI_USAGE;
	return send(h, &command, "configured");
}

static cli_exit add_instrument(hand *h)
{
	cau_command command = command_of(h, CAU_COMMAND_TOOL_ADD);
	if (!take_instrument(h, &command.as.definition))
		return CLI_USAGE;
	snprintf(command.as.definition.name, sizeof command.as.definition.name, "%s", h->tool);
	h->pose = command.as.definition.pose;
	return send(h, &command, "added");
}

static cli_exit act_add(hand *h)
{
	if (cli_value(h->c, "instrument"))
		return add_instrument(h);
	const char *word = h->at < h->c->argument_count ? h->c->arguments[h->at++] : "";
	int32_t shape = cli_shape_of_word(word);
	if (shape < 0) {
#define X(code, word, ...) " " #word
		cli_complain(h->c, "add needs a shape:" CAU_TOOL_SHAPE_TABLE(X));
#undef X
		return CLI_USAGE;
	}
	cau_command command = command_of(h, CAU_COMMAND_TOOL_ADD);
	cau_default_tool_def(&command.as.definition, shape);
	snprintf(command.as.definition.name, sizeof command.as.definition.name, "%s", h->tool);
	h->pose = command.as.definition.pose;
	return send(h, &command, "added");
}

static cli_exit act_remove(hand *h)
{
	cau_command command = command_of(h, CAU_COMMAND_TOOL_REMOVE);
	return send(h, &command, "removed");
}

static cli_exit act_take(hand *h)
{
	cli_exit code = cli_take(h->c, h->stream, h->tool);
	if (!code && !h->c->json)
		fprintf(h->c->out, "%s: taken over\n", h->tool);
	return code;
}

static cli_exit act_move(hand *h)
{
	return take_numbers(h, "move", 3, h->pose.position_m) ? send_pose(h, "moved") : CLI_USAGE;
}

static cli_exit act_turn(hand *h)
{
	return take_numbers(h, "turn", 4, h->pose.rotation) ? send_pose(h, "turned") : CLI_USAGE;
}

static cli_exit act_jaw(hand *h)
{
	return take_numbers(h, "jaw", 1, &h->jaw) ? send_pose(h, "jaw set") : CLI_USAGE;
}

// Waits for `seconds` and keeps the connection alive.
static cli_exit wait_for(hand *h, double seconds)
{
	cli *c = h->c;
	double until_s = cau_client_now() + seconds;
	for (double now_s; (now_s = cau_client_now()) < until_s && !cli_interrupted();) {
		if (cau_client_get_condition(c->client) != CAU_CLIENT_READY) {
			c->error = *cau_client_trouble(c->client);
			return cli_fail(c);
		}
		cau_loop_wait(c->loop, fmin(until_s - now_s, 0.25));
	}
	return CLI_DONE;
}

static cli_exit act_wait(hand *h)
{
	double seconds;
	return take_numbers(h, "wait", 1, &seconds) ? wait_for(h, seconds) : CLI_USAGE;
}

// Moves the tip along a straight line at the given speed, with a pose every sixtieth of a second.
static cli_exit act_line(hand *h)
{
	double to[4], from[3], length = 0; // to: target in m, then the speed in m/s
	cli_exit code = CLI_DONE;
	if (!take_numbers(h, "line", 4, to))
		return CLI_USAGE;
	memcpy(from, h->pose.position_m, sizeof from);
	for (int a = 0; a < 3; a++)
		length += (to[a] - from[a]) * (to[a] - from[a]);
	double duration_s = to[3] > 0 ? sqrt(length) / to[3] : 0;
	for (int64_t k = 1; !code && (double)k * move_every_s < duration_s && !cli_interrupted(); k++) {
		double t = (double)k * move_every_s;
		cau_command command = command_of(h, CAU_COMMAND_TOOL_MOVE);
		for (int a = 0; a < 3; a++)
			h->pose.position_m[a] = from[a] + t / duration_s * (to[a] - from[a]);
		command.as.move.pose = h->pose;
		command.as.move.jaw = h->jaw;
		if (cau_client_move(h->c->client, h->c->session, &command, &h->c->error))
			return cli_fail(h->c);
		code = wait_for(h, move_every_s);
	}
	memcpy(h->pose.position_m, to, sizeof h->pose.position_m);
	return code ? code : send_pose(h, "at the end of the line");
}

static cli_exit switch_energy(hand *h, int32_t on, int32_t ticks)
{
	cau_command command = command_of(h, CAU_COMMAND_TOOL_ENERGIZE);
	command.as.energized = on;
	command.as.ticks = ticks;
	return send(h, &command, on ? "energy on" : "energy off");
}

// Turns energy on. A number after `on` limits the time, in ticks.
static cli_exit act_on(hand *h)
{
	double ticks = 0;
	const char *next = h->at < h->c->argument_count ? h->c->arguments[h->at] : "";
	if (*next >= '0' && *next <= '9') {
		if (!cli_read_number(h->c, "on", next, 0, INT32_MAX, &ticks))
			return CLI_USAGE;
		h->at++;
	}
	return switch_energy(h, 1, (int32_t)ticks);
}

static cli_exit act_off(hand *h)
{
	return switch_energy(h, 0, 0);
}

static cli_exit act_grasp(hand *h)
{
	cau_command command = command_of(h, CAU_COMMAND_TOOL_GRASP);
	return send(h, &command, "grasped");
}

static cli_exit act_release(hand *h)
{
	cau_command command = command_of(h, CAU_COMMAND_TOOL_RELEASE);
	return send(h, &command, "released");
}

static cli_exit act_give(hand *h)
{
	cli *c = h->c;
	cau_wire_tool_hand_over params = {0};
	snprintf(params.tool, sizeof params.tool, "%s", h->tool);
	CLI_CHANGE_PARAMS(c, &params);
	if (cau_client_call(c->client, CAU_METHOD_TOOL_HAND_OVER, &params, NULL, &c->error))
		return cli_fail(c);
	if (!c->json)
		fprintf(c->out, "%s now has no driver\n", h->tool);
	return CLI_DONE;
}

static const struct {
	const char *word;
	bool drives; // the action needs this client to be the driver
	cli_exit (*act)(hand *h);
} actions[] = {
	{"add", false, act_add},    {"remove", false, act_remove},
	{"take", false, act_take},  {"give", true, act_give},
	{"move", true, act_move},   {"line", true, act_line},
	{"turn", true, act_turn},   {"jaw", true, act_jaw},
	{"on", true, act_on},       {"off", false, act_off},
	{"grasp", true, act_grasp}, {"release", true, act_release},
	{"wait", false, act_wait},  {"configure", true, act_configure},
};

enum { ACTION_COUNT = sizeof actions / sizeof *actions };

static cli_exit act(hand *h)
{
	const char *word = h->c->arguments[h->at++];
	for (size_t i = 0; i < ACTION_COUNT; i++) {
		if (strcmp(word, actions[i].word) != 0)
			continue;
		cli_exit code = actions[i].drives ? cli_take(h->c, h->stream, h->tool) : CLI_DONE;
		return code ? code : actions[i].act(h);
	}
	const char *words[ACTION_COUNT];
	for (size_t i = 0; i < ACTION_COUNT; i++)
		words[i] = actions[i].word;
	cli_complain_unknown(h->c, "action", word, words, ACTION_COUNT);
	return CLI_USAGE;
}

static cli_exit run(cli *c)
{
	hand h = {.c = c, .pose = {.rotation = {1, 0, 0, 0}}, .at = 2};
	snprintf(c->session, sizeof c->session, "%s", c->arguments[0]);
	h.tool = c->arguments[1];
	if (!cau_name_is_valid(h.tool)) {
		cli_complain(c, "\"%s\" is not a valid name: %s", h.tool, CAU_NAME_RULE);
		return CLI_USAGE;
	}
	cli_watch_signals();
	cli_exit code = cli_connect(c);
	if (!code)
		code = cli_join_tools(c, &h.stream);
	if (code)
		return code;
	const cau_stream_tool *found = cli_find_tool(h.stream, h.tool);
	if (found) {
		h.pose = found->asked_pose;
		// During a grasp the jaws are taken as open, because a release leaves them open.
		h.jaw = found->grasping ? 1 : found->asked_jaw;
		h.sequence = (int64_t)found->sequence;
	}
	cau_client_keep_alive(c->client, true);
	while (!code && h.at < c->argument_count && !cli_interrupted())
		code = act(&h);
	return !code && cli_interrupted() ? CLI_INCOMPLETE : code;
}

const cli_command cli_tool = {
	.name = "tool",
	.arguments = "SESSION TOOL ACTION...",
	.summary = "adds, moves or energizes a tool, by actions one after the other",
	.help =
		"Actions: add SHAPE, remove, take, give, move X Y Z, line X Y Z SPEED, turn W X Y Z,\n"
		"jaw J, on [TICKS], off, grasp, release, wait S, configure. X, Y and Z are in m, SPEED\n"
		"in m/s, S in s. W X Y Z is a unit quaternion. J is 0 (closed) to 1 (open). After TICKS\n"
		"ticks energy goes off. Actions that need the driver take the tool first. Energy goes\n"
		"off when the command ends:\n"
		"  cautery tool d1-demo hook move 0 0 0 on wait 3 line 0.02 0 0 0.002 off\n"
		"With --instrument, `configure` makes the tool that instrument, and `add` adds it:\n"
		"  cautery tool d1-demo hook configure --instrument monopolar-hook --mode blend\n",
	.least = 3,
	.most = CLI_ARGUMENTS_MAX,
	.options =
		{{"instrument", "NAME",
          "for add and configure: the name of an instrument (`cautery instruments` lists them)"},
         {"mode", "MODE", "mode of the instrument (default: its first)"},
         {"power-w", "W", "power, W, in the range of the mode"}},
	.run = run};

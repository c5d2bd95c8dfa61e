// SPDX-License-Identifier: GPL-3.0-or-later
// How to write a client of Cautery, in one file. Read it from main() at the bottom upwards.
//
// A client talks to cauteryd over one WebSocket. Text messages are JSON-RPC 2.0 in both directions.
// The comment above each call below shows its messages. Binary messages from the server are frames
// with moved vertices, removed faces and poses of tools. protocol/README.md defines all messages;
// this file is an introduction. The client library (cautery/client.h) does what every client needs:
// the socket, hello, ids, decoding, requesting a key frame after a gap, and reconnecting.
//
//     cautery-teaching [ws://127.0.0.1:8740]
//
// The program creates a session of the scene `fascia`, a taut sheet pinned at its rim. It lowers
// the hook onto the sheet, turns its energy on, and waits until heat parts the first edges. Then it
// draws a cut and removes the session.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/client.h"
#include "cautery/defaults.h"

// The cut on the sheet at z = 0: where the hook is lowered, and the end of its motion. SI units.
static const double cut_from_m[3] = {-0.01, 0.0, 0.0};
static const double cut_to_m[3] = {0.01, 0.0, 0.0};
static const double cut_speed_m_s = 0.004;
// Rest with energy on, s. An edge inside the hook parts after 2.35 s.
static const double dwell_s = 3.0;
static const double wait_s = 0.1; // longest wait for a frame
static const double report_every_s = 0.5;

static const char tool_name[] = "hook"; // name of the tool in the scene

// The state of the program.
typedef struct lesson {
	cau_loop *loop;
	cau_client *client;
	cau_client_stream *stream;
	char session[CAU_NAME_BYTES];
	int64_t faces_at_first;
	uint64_t sequence; // counts the commands; frames show the last applied one
	double report_due_s;
} lesson;

// ---- watching ----------------------------------------------------------------------------------

// Returns the lowest height of a vertex. The library decodes every frame into one state, the
// newest. A position is a whole number of description.step_m, exactly as the server holds it, so
// deltas never drift.
static double deepest_m(const cau_client_stream *stream)
{
	const cau_stream_def *def = &stream->def;
	int32_t least = 0;
	for (int32_t i = 0; i < def->vertex_count; i++) {
		int32_t z = stream->state->quantised[3 * i + 2];
		least = z < least ? z : least;
	}
	return def->origin_m[2] + def->step_m * least;
}

static void report(lesson *l)
{
	const cau_stream_state *state = l->stream->state;
	if (!state->synced || cau_client_now() < l->report_due_s)
		return;
	l->report_due_s = cau_client_now() + report_every_s;
	printf("tick %5llu  %4d vertices moved  %3lld faces gone  deepest point %6.2f mm",
	       (unsigned long long)state->tick, state->moved_count,
	       (long long)(l->faces_at_first - cau_client_faces_drawn(l->stream)),
	       1e3 * deepest_m(l->stream));
	for (int32_t i = 0; i < state->tool_count; i++) // a client need not know the tools beforehand
		printf("  %s: energy %s, %.0f degC, %.2f N", state->tools[i].name,
		       state->tools[i].energized ? "on" : "off", state->tools[i].tip_temperature_c,
		       hypot(hypot(state->tools[i].force_n[0], state->tools[i].force_n[1]),
		             state->tools[i].force_n[2]));
	printf("\n");
	fflush(stdout);
}

// ---- driving -----------------------------------------------------------------------------------

// Sends a pose as a notification. The server sends no answer. If several poses arrive within a
// tick, the newest counts.
//
//     {"jsonrpc": "2.0", "method": "tool.move", "params": {"session": "d1-lesson", "tool": "hook",
//      "sequence": 7, "position_m": [0, 0, 0.002], "rotation": [1, 0, 0, 0], "jaw": 0}}
static cau_status move(lesson *l, const double position_m[3], cau_error *error)
{
	cau_command command;
	cau_default_command(&command, CAU_COMMAND_TOOL_MOVE);
	snprintf(command.tool, sizeof command.tool, "%s", tool_name);
	command.sequence = ++l->sequence;
	memcpy(command.as.move.pose.position_m, position_m, 3 * sizeof *position_m);
	return cau_client_move(l->client, l->session, &command, error);
}

// Turns energy on or off by a request. The answer comes when the command is in the store and will
// survive a crash. The library counts "client_sequence". With it, a request that must be sent twice
// acts only once.
//
//     --> {"jsonrpc": "2.0", "id": 4, "method": "tool.energize", "params": {"session": "d1-lesson",
//          "client_sequence": 3, "tool": "hook", "sequence": 8, "energized": true}}
//     <-- {"jsonrpc": "2.0", "id": 4, "result": {"tick": 95, "sequence": 8}}
static cau_status energize(lesson *l, int32_t on, cau_error *error)
{
	cau_command command;
	cau_wire_command_result result;
	cau_default_command(&command, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(command.tool, sizeof command.tool, "%s", tool_name);
	command.sequence = ++l->sequence;
	command.as.energized = on;
	cau_status status = cau_client_command(l->client, l->session, &command, &result, error);
	if (!status)
		printf("energy %s from tick %lld\n", on ? "on" : "off", (long long)result.tick);
	return status;
}

// Moves from one point to another in `seconds` of simulated time, with one pose for each received
// frame. On a busy server simulated time is slower than real time. A cut by the real clock would
// then be too fast to part the tissue. Everything else (frames in, heartbeats out) happens inside
// cau_loop_wait.
static cau_status draw(lesson *l, const double from_m[3], const double to_m[3], double seconds,
                       cau_error *error)
{
	const cau_stream_state *state = l->stream->state;
	double start_s = state->time_s, last_s = -1;
	while (state->time_s < start_s + seconds) {
		if (cau_client_get_condition(l->client) != CAU_CLIENT_READY) {
			*error = *cau_client_trouble(l->client);
			return CAU_IO;
		}
		if (state->time_s != last_s) {
			double share = (state->time_s - start_s) / seconds, position_m[3];
			last_s = state->time_s;
			for (int a = 0; a < 3; a++)
				position_m[a] = from_m[a] + share * (to_m[a] - from_m[a]);
			cau_status status = move(l, position_m, error);
			if (status)
				return status;
		}
		report(l);
		cau_loop_wait(l->loop, wait_s);
	}
	return CAU_OK;
}

// Becomes the tool's driver. A tool has one driver. The tools of a new session have none, so the
// first client that asks becomes the driver.
//
//     --> {"jsonrpc": "2.0", "id": 3, "method": "tool.take_over",
//          "params": {"session": "d1-lesson", "client_sequence": 2, "tool": "hook"}}
static cau_status take_tool(lesson *l, cau_error *error)
{
	cau_wire_tool_ref params = {.has_session = true, .has_client_sequence = true};
	snprintf(params.session, sizeof params.session, "%s", l->session);
	snprintf(params.tool, sizeof params.tool, "%s", tool_name);
	params.client_sequence = cau_client_next_sequence(l->client);
	return cau_client_call(l->client, CAU_METHOD_TOOL_TAKE_OVER, &params, NULL, error);
}

static cau_status cut(lesson *l, cau_error *error)
{
	const double above_m[3] = {cut_from_m[0], cut_from_m[1], 0.03};
	double length_m = hypot(cut_to_m[0] - cut_from_m[0], cut_to_m[1] - cut_from_m[1]);
	cau_status status = take_tool(l, error);
	if (status)
		return status;
	// The server turns energy off after 250 ms without a message from the driver. This call sends a
	// heartbeat every 100 ms, as long as the program keeps calling cau_loop_wait.
	cau_client_keep_alive(l->client, true);
	status = draw(l, above_m, cut_from_m, 1.0, error);
	if (!status)
		status = energize(l, 1, error);
	if (!status)
		status = draw(l, cut_from_m, cut_from_m, dwell_s, error);
	if (!status)
		status = draw(l, cut_from_m, cut_to_m, length_m / cut_speed_m_s, error);
	if (!status)
		status = energize(l, 0, error);
	return status ? status : draw(l, cut_to_m, above_m, 1.0, error);
}

// ---- the session -------------------------------------------------------------------------------

// Creates the session.
//
//     --> {"jsonrpc": "2.0", "id": 1, "method": "session.create",
//          "params": {"client_sequence": 1, "scene": "fascia"}}
//     <-- {"jsonrpc": "2.0", "id": 1, "result": {"summary": {"session": "d1-fascia-1", ...}, ...}}
static cau_status create_session(lesson *l, cau_error *error)
{
	cau_wire_session_create params = {.has_client_sequence = true, .has_scene = true};
	cau_wire_layer_description layers[CAU_MAX_LAYERS];
	cau_wire_driver drivers[CAU_MAX_TOOLS];
	// Lists in an answer are stored in the caller's arrays. The scene is skipped, because
	// `definition` is NULL.
	cau_wire_session_description made = {.layers = {layers, 0, CAU_MAX_LAYERS},
	                                     .drivers = {drivers, 0, CAU_MAX_TOOLS}};
	params.client_sequence = cau_client_next_sequence(l->client);
	snprintf(params.scene, sizeof params.scene, "%s", "fascia");
	cau_status status =
		cau_client_call(l->client, CAU_METHOD_SESSION_CREATE, &params, &made, error);
	if (status)
		return status;
	snprintf(l->session, sizeof l->session, "%s", made.summary.session);
	printf("session %s: %lld vertices, %lld faces, a tick is %.1f ms\n", l->session,
	       (long long)made.summary.vertex_count, (long long)made.summary.face_count,
	       1e3 * made.summary.step_s);
	return CAU_OK;
}

// Joins the session and waits for the first key frame.
//
//     --> {"jsonrpc": "2.0", "id": 2, "method": "session.join",
//          "params": {"session": "d1-fascia-1"}}
//     <-- {"jsonrpc": "2.0", "id": 2, "result": {"session_number": 1, "vertex_count": 3111,
//          "step_m": 5e-05, "origin_m": [...], ...}}
//     <-- binary: the topology (once), a key frame, then deltas
static cau_status join_session(lesson *l, cau_error *error)
{
	cau_wire_session_join params = {.has_session = true};
	snprintf(params.session, sizeof params.session, "%s", l->session);
	cau_status status = cau_client_join(l->client, &params, &l->stream, error);
	if (!status)
		l->faces_at_first = cau_client_faces_drawn(l->stream);
	return status;
}

// Removes the session.
//
//     --> {"jsonrpc": "2.0", "id": 9, "method": "session.destroy", "params": {...}}
static cau_status remove_session(lesson *l, cau_error *error)
{
	cau_wire_session_change params = {.has_session = true, .has_client_sequence = true};
	snprintf(params.session, sizeof params.session, "%s", l->session);
	params.client_sequence = cau_client_next_sequence(l->client);
	return cau_client_call(l->client, CAU_METHOD_SESSION_DESTROY, &params, NULL, error);
}

// Connects. The first message is hello; cau_client_connect sends it and waits for the answer.
//
//     --> {"jsonrpc": "2.0", "id": 0, "method": "hello", "params": {"version": 1,
//          "client": "cautery-teaching"}}
//     <-- {"jsonrpc": "2.0", "id": 0, "result": {"server": "cauteryd 0.1.0", "role": "admin",
//          "client": 1, "resume": "...", "limits": {...}, "server_time_us": 81234567, ...}}
static cau_status connect_to(lesson *l, const char *url, cau_error *error)
{
	cau_client_def def = cau_default_client_def();
	def.url = url;
	def.name = "cautery-teaching";
	cau_status status = cau_loop_create(&l->loop, error);
	if (!status)
		status = cau_client_create(l->loop, &def, &l->client, error);
	if (!status)
		status = cau_client_connect(l->client, error);
	if (!status)
		printf("connected to %s as client %lld\n", cau_client_server(l->client)->server,
		       (long long)cau_client_server(l->client)->client);
	return status;
}

int main(int argument_count, char **arguments)
{
	lesson l = {0};
	cau_error error = {0};
	cau_status status =
		connect_to(&l, argument_count > 1 ? arguments[1] : CAU_CLIENT_DEFAULT_URL, &error);
	if (!status)
		status = create_session(&l, &error);
	if (!status)
		status = join_session(&l, &error);
	if (!status)
		status = cut(&l, &error);
	if (!status)
		status = remove_session(&l, &error);
	if (status) // an error has a status, a path and a reason
		fprintf(stderr, "cautery-teaching: %s %s\n", error.path, error.reason);
	if (l.client)
		cau_client_close(l.client);
	cau_client_destroy(l.client);
	cau_loop_destroy(l.loop);
	return status ? EXIT_FAILURE : EXIT_SUCCESS;
}

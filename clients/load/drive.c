// SPDX-License-Identifier: GPL-3.0-or-later
// Drivers repeat the scene's own cut as tool moves. Most moves are notifications. Every half second
// one is a request, and the log must have each acknowledged request.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/command_json.h"
#include "cautery/defaults.h"
#include "load/load.h"

// Interval between two moves, s. It is not a multiple of the tick, so commands arrive at every
// phase of the tick.
static const double move_every_s = 0.0173;
static const double request_every_s = 0.5;

// Computes the position at `time_s`: along the cut and back, after the dwell.
static void place(const cau_cut_def *cut, double time_s, double position_m[3])
{
	double length_m = 0;
	for (int a = 0; a < 3; a++)
		length_m += (cut->to_m[a] - cut->from_m[a]) * (cut->to_m[a] - cut->from_m[a]);
	length_m = sqrt(length_m);
	double way_m = fmax(0, time_s - cut->dwell_s) * cut->speed_m_s;
	double share = length_m > 0 ? fmod(way_m / length_m, 2.0) : 0;
	share = share > 1 ? 2 - share : share;
	for (int a = 0; a < 3; a++)
		position_m[a] = cut->from_m[a] + share * (cut->to_m[a] - cut->from_m[a]);
}

static cau_command next_move(load_session *session, double now_s)
{
	cau_command command;
	load_driver *driver = &session->driver;
	cau_default_command(&command, CAU_COMMAND_TOOL_MOVE);
	memcpy(command.tool, session->tool, sizeof command.tool);
	command.sequence = (uint64_t)++driver->sequence;
	place(&session->cut, now_s - driver->start_s, command.as.move.pose.position_m);
	memcpy(command.as.move.pose.rotation, session->cut.rotation,
	       sizeof command.as.move.pose.rotation);
	driver->sent_s[driver->sequence % LOAD_OPEN_COMMANDS] = now_s;
	return command;
}

static void acknowledged(void *user, const cau_rpc_message *answer, const cau_error *error)
{
	load_session *session = user;
	cau_wire_command_result result = {0};
	(void)error;
	if (!answer || cau_rpc_result(answer, CAU_METHOD_TOOL_MOVE, &result, NULL))
		session->fleet->refused++;
	else if (session->driver.acknowledged_count < LOAD_ACKNOWLEDGED_MAX)
		session->driver.acknowledged[session->driver.acknowledged_count++] = result.sequence;
}

cau_status load_drive(load_session *session, double now_s)
{
	load_driver *driver = &session->driver;
	load_fleet *fleet = session->fleet;
	cau_client *client = session->viewers[0].client;
	cau_status status = CAU_OK;
	if (now_s < driver->due_s)
		return CAU_OK;
	cau_command command = next_move(session, now_s);
	if (now_s >= driver->request_due_s) {
		driver->request_due_s = now_s + request_every_s;
		status = cau_client_send_command(client, session->id, &command, acknowledged, session,
		                                 &fleet->error);
	} else {
		status = cau_client_move(client, session->id, &command, &fleet->error);
	}
	driver->due_s = fmax(driver->due_s + move_every_s, now_s - move_every_s);
	fleet->commands += fleet->measuring;
	return status;
}

void load_note_command(load_session *session, double decoded_s)
{
	load_driver *driver = &session->driver;
	load_fleet *fleet = session->fleet;
	const cau_stream_state *state = session->viewers[0].stream->state;
	int64_t applied = 0;
	for (int32_t i = 0; i < state->tool_count; i++)
		if (strcmp(state->tools[i].name, session->tool) == 0)
			applied = (int64_t)state->tools[i].sequence;
	if (applied > driver->sequence)
		return; // the frame shows a command of an earlier run
	int64_t oldest = driver->sequence - LOAD_OPEN_COMMANDS + 1;
	for (int64_t s = driver->shown + 1; s <= applied; s++)
		if (fleet->measuring && s >= oldest)
			load_samples_add(&fleet->command_ms,
			                 1e3 * (decoded_s - driver->sent_s[s % LOAD_OPEN_COMMANDS]));
	if (applied > driver->shown)
		driver->shown = applied;
}

// ---- compare with the log ----------------------------------------------------------------------
static int ascending(const void *a, const void *b)
{
	int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
	return (x > y) - (x < y);
}

static cau_status strike_out(load_session *session, const char *text, size_t bytes, int64_t *lost,
                             cau_error *error)
{
	cau_script script;
	cau_command command;
	bool end = false;
	cau_status status = CAU_OK;
	load_driver *driver = &session->driver;
	size_t count = (size_t)driver->acknowledged_count;
	bool *found = calloc(count + 1, sizeof *found);
	if (!found)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to read a log");
	cau_script_begin(&script, "log", text, bytes);
	while (!status && !end) {
		status = cau_script_next(&script, &command, &end, error);
		if (status || end || command.kind != CAU_COMMAND_TOOL_MOVE)
			continue;
		int64_t sequence = (int64_t)command.sequence;
		const int64_t *at =
			bsearch(&sequence, driver->acknowledged, count, sizeof sequence, ascending);
		if (at)
			found[at - driver->acknowledged] = true;
	}
	for (size_t i = 0; i < count; i++)
		*lost += !found[i];
	free(found);
	return status;
}

cau_status load_count_lost(load_session *session, int64_t *lost, cau_error *error)
{
	cau_wire_session_log params = {.has_session = true};
	cau_wire_transfer transfer = {0};
	unsigned char *text = NULL;
	load_driver *driver = &session->driver;
	memcpy(params.session, session->id, sizeof params.session);
	qsort(driver->acknowledged, (size_t)driver->acknowledged_count, sizeof *driver->acknowledged,
	      ascending);
	cau_status status = cau_client_download(session->viewers[0].client, CAU_METHOD_SESSION_LOG,
	                                        &params, NULL, NULL, &transfer, &text, error);
	if (!status)
		status = strike_out(session, (const char *)text, (size_t)transfer.byte_count, lost, error);
	free(text);
	return status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Brings a core to a stored state: restores the nearest checkpoint, then replays the log. The
// replay runs in slices, so that other sessions keep their pace.
#include <stdlib.h>
#include <string.h>

#include "cautery/command_json.h"
#include "clock/clock.h"
#include "hosted_session/record.h"

cau_status cau_replay_check(const cau_hosted_identity *identity, const cau_hosted_commits *commits,
                            int64_t branch, bool present, uint64_t tick, cau_error *error)
{
	cau_store_flush(identity->around->store);
	uint64_t lost_from = commits->lost_from;
	if (present && tick > lost_from)
		return cau_fail(
			error, CAU_BAD_VALUE, "params.tick",
			"commands from tick %llu on could not be stored: only earlier ticks can be reached",
			(unsigned long long)lost_from);
	return cau_store_check_reach(identity->around->store, identity->id, branch, tick, error);
}

static cau_status take_checkpoint(void *user, const cau_store_checkpoint *checkpoint)
{
	cau_replay *replay = user;
	replay->snapshot = malloc(checkpoint->snapshot.bytes);
	if (!replay->snapshot)
		return CAU_NO_MEMORY;
	memcpy(replay->snapshot, checkpoint->snapshot.data, checkpoint->snapshot.bytes);
	replay->snapshot_bytes = checkpoint->snapshot.bytes;
	replay->from = checkpoint->tick;
	return CAU_OK;
}

static cau_status take_command(void *user, const cau_store_command *row)
{
	cau_replay *replay = user;
	if (replay->count == replay->capacity) {
		size_t capacity = replay->capacity ? 2 * replay->capacity : 256;
		cau_replayed *grown = realloc(replay->commands, capacity * sizeof *grown);
		if (!grown)
			return CAU_NO_MEMORY;
		replay->commands = grown;
		replay->capacity = capacity;
	}
	cau_replayed *made = &replay->commands[replay->count++];
	made->tick = row->tick;
	made->order = row->order;
	made->acts = row->kind != CAU_STORE_REACHED;
	if (!made->acts)
		return CAU_OK;
	return cau_command_from_json(row->payload.data, row->payload.bytes, &made->command, NULL);
}

cau_status cau_replay_read(cau_replay *replay, cau_store *store, const char *session,
                           int64_t branch, uint64_t tick, cau_error *error)
{
	bool to_end = tick == UINT64_MAX;
	uint64_t before = to_end ? INT64_MAX : tick;
	cau_replay_finish(replay);
	cau_status status =
		cau_store_read_checkpoint(store, session, branch, before, take_checkpoint, replay, error);
	if (!status)
		status = cau_store_read_log(store, session, branch, replay->from, before, take_command,
		                            replay, error);
	// This check is the last, because retention may have removed some of the log in the meantime.
	if (!to_end && (!status || status == CAU_NOT_FOUND)) {
		cau_status reached = cau_store_check_reach(store, session, branch, tick, error);
		status = reached ? reached : status;
	}
	if (status) {
		cau_replay_finish(replay);
		return status;
	}
	replay->until = to_end ? replay->from : tick;
	if (to_end && replay->count)
		replay->until = replay->commands[replay->count - 1].tick;
	return CAU_OK;
}

cau_status cau_replay_restore(cau_replay *replay, cau_session *core, cau_error *error)
{
	cau_status status =
		cau_session_restore(core, replay->snapshot, replay->snapshot_bytes, &replay->exact, error);
	if (status) {
		cau_replay_finish(replay);
		return status;
	}
	free(replay->snapshot);
	replay->snapshot = NULL;
	replay->tick = replay->from;
	return CAU_OK;
}

static void submit_due(cau_replay *replay, cau_session *core)
{
	for (; replay->at < replay->count && replay->commands[replay->at].tick <= replay->tick;
	     replay->at++)
		if (replay->commands[replay->at].acts &&
		    cau_session_submit(core, &replay->commands[replay->at].command, NULL))
			replay->exact =
				false; // the core refuses a command that it accepted when the command was logged
}

cau_status cau_replay_slice(cau_replay *replay, cau_session *core, double seconds, bool *over,
                            cau_error *error)
{
	double end_s = cau_monotonic_s() + seconds;
	*over = false;
	while (replay->tick < replay->until) {
		submit_due(replay, core);
		double began_cpu_s = cau_thread_cpu_s();
		cau_status status = cau_session_step(core, error);
		replay->stepped_s += cau_thread_cpu_s() - began_cpu_s;
		if (status)
			return status;
		replay->tick++;
		if (cau_monotonic_s() >= end_s && replay->tick < replay->until)
			return CAU_OK;
	}
	submit_due(replay, core);
	*over = true;
	return CAU_OK;
}

void cau_replay_shorten(cau_replay *replay, uint64_t tick)
{
	replay->from = tick;
	while (replay->at < replay->count && replay->commands[replay->at].tick < tick)
		replay->at++;
}

void cau_replay_finish(cau_replay *replay)
{
	free(replay->commands);
	free(replay->snapshot);
	*replay = (cau_replay){.exact = replay->exact, .tick = replay->tick};
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The way back to a state: the nearest checkpoint, then the log. Runs in slices, so that other
// sessions keep their pace.
#include <stdlib.h>
#include <string.h>

#include "cautery/command_json.h"
#include "hosted_session/internal.h"

#define SLICE_S 0.008

// A checkpoint's copy: the core takes it only once the log is read too.
typedef struct snapshot {
	void *bytes;
	size_t byte_count;
	uint64_t tick;
} snapshot;

static cau_status take_checkpoint(void *user, const cau_store_checkpoint *checkpoint)
{
	snapshot *taken = user;
	taken->bytes = malloc(checkpoint->snapshot.bytes);
	if (!taken->bytes)
		return CAU_NO_MEMORY;
	memcpy(taken->bytes, checkpoint->snapshot.data, checkpoint->snapshot.bytes);
	taken->byte_count = checkpoint->snapshot.bytes;
	taken->tick = checkpoint->tick;
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
	return cau_command_from_json(row->payload.data, row->payload.bytes, &made->command, NULL);
}

cau_status cau_replay_begin(cau_hosted *h, const char *session, int64_t branch, uint64_t tick,
                            cau_order *order, cau_error *error)
{
	cau_store *store = h->around->store;
	cau_replay *replay = &h->replay;
	bool to_end = tick == UINT64_MAX;
	uint64_t before = to_end ? INT64_MAX : tick;
	snapshot taken = {0};
	cau_replay_finish(replay);
	cau_status status =
		cau_store_read_checkpoint(store, session, branch, before, take_checkpoint, &taken, error);
	if (!status)
		status = cau_store_read_log(store, session, branch, taken.tick, before, take_command,
		                            replay, error);
	// Asked last: retention may have taken some of it meanwhile.
	if (!to_end && (!status || status == CAU_NOT_FOUND)) {
		cau_status reached = cau_store_check_reach(store, session, branch, tick, error);
		status = reached ? reached : status;
	}
	if (!status)
		status = cau_session_restore(h->core, taken.bytes, taken.byte_count, &replay->exact, error);
	free(taken.bytes);
	if (status) {
		cau_replay_finish(replay);
		return status;
	}
	h->tick = taken.tick;
	replay->until = to_end ? h->tick : tick;
	if (to_end && replay->count)
		replay->until = replay->commands[replay->count - 1].tick;
	replay->order = order;
	replay->active = true;
	return CAU_OK;
}

static void submit_due(cau_hosted *h)
{
	cau_replay *replay = &h->replay;
	for (; replay->at < replay->count && replay->commands[replay->at].tick <= h->tick; replay->at++)
		cau_session_submit(h->core, &replay->commands[replay->at].command, NULL);
}

bool cau_replay_slice(cau_hosted *h)
{
	cau_error error = {0};
	double end_s = cau_monotonic_s() + SLICE_S;
	while (h->tick < h->replay.until) {
		submit_due(h);
		if (cau_session_step(h->core, &error)) {
			cau_hosted_fault(h, &error);
			return false;
		}
		h->tick++;
		if (cau_monotonic_s() >= end_s && h->tick < h->replay.until)
			return true;
	}
	submit_due(h);
	return false;
}

void cau_replay_finish(cau_replay *replay)
{
	free(replay->commands);
	*replay = (cau_replay){.exact = replay->exact};
}

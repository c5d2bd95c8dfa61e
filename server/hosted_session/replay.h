// SPDX-License-Identifier: GPL-3.0-or-later
// Brings a core to a stored state: restores the nearest checkpoint, then replays the log, in
// slices.
#pragma once

#include "hosted_session/record.h"

// An entry of the log that is being replayed.
typedef struct cau_replayed {
	uint64_t tick;
	uint32_t order;
	bool acts; // false: the entry has no command (CAU_STORE_REACHED)
	cau_command command;
} cau_replayed;

// A replay that is under way. Only one thread at a time may use this struct.
typedef struct cau_replay {
	void *snapshot; // snapshot of the checkpoint, until the core is restored from it
	size_t snapshot_bytes;
	uint64_t from, until; // ticks between which the log is replayed
	uint64_t tick;        // tick of the core
	bool exact;
	double stepped_s; // processor time of the replayed steps
	cau_replayed *commands;
	size_t count, capacity, at;
} cau_replay;

// Checks whether a tick can be reached. Runs on the builder. First waits until all submitted
// batches are in the store. Returns CAU_BAD_VALUE if the tick cannot be reached. `present`: the
// branch is the session's present branch.
cau_status cau_replay_check(const cau_hosted_identity *identity, const cau_hosted_commits *commits,
                            int64_t branch, bool present, uint64_t tick, cau_error *error);
// Reads the checkpoint and the log of a session's branch up to `tick` (UINT64_MAX: the end).
cau_status cau_replay_read(cau_replay *replay, cau_store *store, const char *session,
                           int64_t branch, uint64_t tick, cau_error *error);
// Restores the core from the checkpoint that cau_replay_read has read. After CAU_CORRUPT the core
// is unchanged. After another failure its state is undefined.
cau_status cau_replay_restore(cau_replay *replay, cau_session *core, cau_error *error);
// Replays the log until its end, or for about `seconds`.
cau_status cau_replay_slice(cau_replay *replay, cau_session *core, double seconds, bool *over,
                            cau_error *error);
// Starts the replay later than at the checkpoint: the core, or the snapshot that replaces the
// checkpoint's, is at `tick`.
void cau_replay_shorten(cau_replay *replay, uint64_t tick);
void cau_replay_finish(cau_replay *replay);

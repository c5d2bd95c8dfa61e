// SPDX-License-Identifier: GPL-3.0-or-later
// The way of a core to a state of the store: the nearest checkpoint, then the log, in slices.
#pragma once

#include "hosted_session/record.h"

// An entry of the log that is being replayed.
typedef struct cau_replayed {
	uint64_t tick;
	uint32_t order;
	bool acts; // it has a command: see CAU_STORE_REACHED
	cau_command command;
} cau_replayed;

// By one thread at a time.
typedef struct cau_replay {
	void *snapshot; // of the checkpoint, until the core has it
	size_t snapshot_bytes;
	uint64_t from, until; // ticks
	uint64_t tick;        // where the core is
	bool exact;
	double stepped_s; // processor time of its steps
	cau_replayed *commands;
	size_t count, capacity, at;
} cau_replay;

// On the builder. Before the past is read, all of it that is on its way must be in the store.
// CAU_BAD_VALUE: that tick cannot be reached; `present`: the branch is the present one.
cau_status cau_replay_check(const cau_hosted_identity *identity, const cau_hosted_commits *commits,
                            int64_t branch, bool present, uint64_t tick, cau_error *error);
// Reads the checkpoint and the log of a session's branch up to `tick` (UINT64_MAX: the end).
cau_status cau_replay_read(cau_replay *replay, cau_store *store, const char *session,
                           int64_t branch, uint64_t tick, cau_error *error);
// Has the core be at that checkpoint. After CAU_CORRUPT it is as it was, after another failure it
// may be anywhere.
cau_status cau_replay_restore(cau_replay *replay, cau_session *core, cau_error *error);
// Steps on along the log, until that is over or some seconds are.
cau_status cau_replay_slice(cau_replay *replay, cau_session *core, double seconds, bool *over,
                            cau_error *error);
// The core is, or the snapshot will take it, further than the checkpoint: at `tick`, on this way.
void cau_replay_shorten(cau_replay *replay, uint64_t tick);
void cau_replay_finish(cau_replay *replay);

// SPDX-License-Identifier: GPL-3.0-or-later
// Snapshots of states that past views have passed, in memory and within a budget of bytes. The next
// view can start from such a state instead of an earlier checkpoint of the store. All states belong
// to the line of one branch.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CAU_KEPT_STATES_MOST = 256 };

typedef struct cau_kept_state {
	uint64_t tick;
	bool exact; // from cau_session_restore: the state is exact
	void *bytes;
	size_t byte_count;
} cau_kept_state;

// A zeroed struct is empty.
typedef struct cau_kept_states {
	int64_t branch;
	int32_t count;
	size_t byte_count;                          // bytes of all snapshots
	cau_kept_state state[CAU_KEPT_STATES_MOST]; // in ascending order of ticks
} cau_kept_states;

// Adds a state and takes ownership of its malloc'ed bytes. The new state replaces a state of the
// same tick. Beyond `budget`, states are dropped whose neighbours are closest to each other. States
// of another branch are dropped first.
void cau_kept_states_put(cau_kept_states *kept, size_t budget, int64_t branch,
                         const cau_kept_state *state);
// Returns the newest state at or before the tick, or NULL.
const cau_kept_state *cau_kept_states_find(const cau_kept_states *kept, int64_t branch,
                                           uint64_t tick);
void cau_kept_states_finish(cau_kept_states *kept);

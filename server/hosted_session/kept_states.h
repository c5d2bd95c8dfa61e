// SPDX-License-Identifier: GPL-3.0-or-later
// Snapshots of states that a look at the past came by, in memory and under a budget of bytes, so
// that the next look begins nearer than the store's checkpoint. All are of one branch's line.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CAU_KEPT_STATES_MOST = 256 };

typedef struct cau_kept_state {
	uint64_t tick;
	bool exact; // as cau_session_restore tells
	void *bytes;
	size_t byte_count;
} cau_kept_state;

// Zeroed: none.
typedef struct cau_kept_states {
	int64_t branch;
	int32_t count;
	size_t byte_count;                          // of all
	cau_kept_state state[CAU_KEPT_STATES_MOST]; // ticks ascend
} cau_kept_states;

// Takes the state and its bytes (malloc'ed). One of its tick gives way to it, and beyond `budget`
// those do that stand closest between their neighbours. States of another branch go.
void cau_kept_states_put(cau_kept_states *kept, size_t budget, int64_t branch,
                         const cau_kept_state *state);
// The newest at or before the tick; NULL: there is none.
const cau_kept_state *cau_kept_states_find(const cau_kept_states *kept, int64_t branch,
                                           uint64_t tick);
void cau_kept_states_finish(cau_kept_states *kept);

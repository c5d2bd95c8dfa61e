// SPDX-License-Identifier: GPL-3.0-or-later
// The states that a search has found, each with the way to it.
#pragma once

#include "server/session/reach_state.h"

typedef struct reach_found {
	reach_packed *states;
	uint32_t *parents;
	uint8_t *by;     // the event that led from the parent
	uint32_t *slots; // open addressing; 0: free, else the state's number and 1
	uint32_t count, capacity, most, slot_count;
} reach_found;

// Holds up to `most` states; memory is taken as they are found.
void reach_found_init(reach_found *found, uint32_t most);
void reach_found_finish(reach_found *found);
// Adds the state if it is new. False: there is no room for it.
bool reach_found_add(reach_found *found, const reach_packed *state, uint32_t parent, int by);

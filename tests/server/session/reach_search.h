// SPDX-License-Identifier: GPL-3.0-or-later
// The states that a search has found, each with the path to it.
#pragma once

#include "server/session/reach_state.h"

typedef struct reach_found {
	reach_packed *states;
	uint32_t *parents;
	uint8_t *by;     // the event that led from the parent
	uint32_t *slots; // open addressing; 0: unused slot, else the state's number + 1
	uint32_t count, capacity, most, slot_count;
} reach_found;

// Prepares for up to `most` states. Memory is allocated as states are found.
void reach_found_init(reach_found *found, uint32_t most);
void reach_found_finish(reach_found *found);
// Adds the state if it is new. Returns false if `most` states are stored already.
bool reach_found_add(reach_found *found, const reach_packed *state, uint32_t parent, int by);

// SPDX-License-Identifier: GPL-3.0-or-later
// Applies one event to one state of a session's machine, and checks the result by rules that keep
// their own books beside the machine.
#pragma once

#include "server/session/reach_state.h"

typedef enum reach_what {
	REACH_ORDER,
	REACH_ALIVE,
	REACH_AWAY,
	REACH_FORGET,
	REACH_SILENCE,    // time passes until all drivers are silent
	REACH_LOOK,       // the watchdog checks for silence
	REACH_STORE,      // the store becomes full, or has capacity again
	REACH_COMMITTED,  // all batches are on the disk
	REACH_WORK_EARLY, // the worker asks before the next tick is due
	REACH_WORK,       // the worker asks when the next tick is due
	REACH_DONE,
	REACH_NOT_DONE,  // the core refuses the order, or the store has its earlier answer
	REACH_POSTPONED, // the order's earlier answer is on its way to the disk
	REACH_FAULTED,   // a step ends in numerical trouble
	REACH_ARRIVE_OFF,
	REACH_ARRIVE_ENERGIZED,
	REACH_STAY, // a rewind, reset or restore fails
	REACH_DRAIN,
	REACH_END,
	REACH_WHAT_COUNT
} reach_what;

extern const char *const reach_what_names[REACH_WHAT_COUNT];

typedef struct reach_event {
	reach_what what;
	cau_ask ask;
	int client, tool, to;
	int later; // number of ticks from now at which the order takes effect
	bool numbered;
} reach_event;

typedef struct reach_move {
	cau_logic *logic, *scratch;
	// machine before the event; shared by all events of a state, so no event changes it
	const cau_logic *before;
	bool silence_is_cut; // `scratch` is `before` with the energy of silent drivers off
	cau_action action;
	cau_effects effects;
	reach_state books;
	const char *wrong; // the broken rule; NULL: none
} reach_move;

bool reach_can_be(const reach_event *event, const reach_state *state);
// Applies the event to `move->logic`. `before` and `books` must hold the same state.
void reach_do(reach_move *move, const reach_event *event);

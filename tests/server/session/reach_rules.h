// SPDX-License-Identifier: GPL-3.0-or-later
// One event in one state of a session's machine, and what must be true of it: rules that keep their
// own books beside the machine's.
#pragma once

#include "server/session/reach_state.h"

typedef enum reach_what {
	REACH_ORDER,
	REACH_ALIVE,
	REACH_AWAY,
	REACH_FORGET,
	REACH_SILENCE,    // time passes until all are silent
	REACH_LOOK,       // the watchdog looks
	REACH_STORE,      // it fills, or has room again
	REACH_COMMITTED,  // what was on its way to the disk is there
	REACH_WORK_EARLY, // the worker asks before the next tick is due
	REACH_WORK,       // or when it is
	REACH_DONE,
	REACH_NOT_DONE,  // by the core; what was looked for is answered
	REACH_POSTPONED, // what was looked for is on its way to the disk
	REACH_FAULTED,   // a step ends in numerical trouble
	REACH_ARRIVE_DARK,
	REACH_ARRIVE_LIT,
	REACH_STAY, // what was to be gone to cannot be
	REACH_DRAIN,
	REACH_END,
	REACH_WHAT_COUNT
} reach_what;

extern const char *const reach_what_names[REACH_WHAT_COUNT];

typedef struct reach_event {
	reach_what what;
	cau_ask ask;
	int client, tool, to;
	int later; // the order is for so many ticks from now
	bool numbered;
} reach_event;

typedef struct reach_move {
	cau_logic *logic, *scratch;
	const cau_logic *before; // the event; of all events of a state, so none changes it
	bool
		silence_is_cut; // `scratch` is `before`, with energy off for drivers that are silent by now
	cau_action action;
	cau_effects effects;
	reach_state books;
	const char *wrong; // NULL: nothing
} reach_move;

bool reach_can_be(const reach_event *event, const reach_state *state);
// `move` holds the state in `logic`, `before` and `books`.
void reach_do(reach_move *move, const reach_event *event);

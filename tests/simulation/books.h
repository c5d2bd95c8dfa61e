// SPDX-License-Identifier: GPL-3.0-or-later
// What the simulation knows of a session from outside: who may have energy on, and what was
// acknowledged. Commands that set gravity stand for all commands: each sets a number of its own, so
// the state shows which was the newest.
#pragma once

#include "simulation/world.h"

typedef enum energy {
	ENERGY_ALLOWED,
	ENERGY_CUT,    // no enable counts
	ENERGY_SILENT, // one would, but its client was silent for too long
} energy;

typedef struct session_book {
	bool made, restarted;               // restarted: its state is still to be compared
	bool full;                          // its store takes nothing
	int64_t enabled_ns[TOOLS][CLIENTS]; // arrival of an enable that no cut has voided; 0: none
	bool in_ticks[CLIENTS];             // silence of a client in lock-step is not of the clock
	bool by_ticks[TOOLS][CLIENTS];      // the enable came with a request of lock-step
	int ticks_left[CLIENTS];            // with energy, that requests of lock-step allow
	int applied[GRAVITIES_MOST];        // place in the order of taking effect; 0: never
	bool acknowledged[GRAVITIES_MOST];
	int last_applied;            // places given
	int floor;                   // place of the newest that was acknowledged on this line
	int line_from;               // what was applied up to here may be gone by a rewind
	bool leaving;                // a rewind is under way
	int last_of_client[CLIENTS]; // number of the last that took effect
} session_book;

extern session_book sim_books[SESSIONS];

// Expensive requests of each client that a daemon did since its start.
typedef struct quota_book {
	int64_t from_ns;
	int done[CLIENTS];
} quota_book;

extern quota_book sim_quotas[DISK_MACHINES];

// gravity.set with a number: the command's text, and back from the state.
double books_gravity(int number);
int books_number(double gravity); // 0: another one

energy promises_energy(int session, int tool, int64_t at_ns);
// The client whose ticks in lock-step alone allow the tool's energy; -1: there is another reason,
// or none.
int promises_by_ticks(int session, int tool, int64_t at_ns);

// A rewind was asked for; it has come to its end, one way or the other.
void books_line_leaves(session_book *book);
void books_line_arrives(session_book *book);
void books_acknowledge(session_book *book, int number);
// The daemon gives the core an order that it does now, not one that it replays.
void books_apply(session_book *book, int number);
// The state that a session has after a restart.
void books_compare(session_book *book, int place, int number);

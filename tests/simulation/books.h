// SPDX-License-Identifier: GPL-3.0-or-later
// The simulation's knowledge of a session from outside: which clients may have energy on, and which
// commands were acknowledged. Commands that set gravity represent all commands. Each such command
// has a number, and sets a gravity that no other number has. So the state shows which command was
// the newest.
#pragma once

#include "simulation/world.h"

typedef enum energy {
	ENERGY_ALLOWED,
	ENERGY_CUT,    // every enable was voided by a cut
	ENERGY_SILENT, // an enable is valid, but its client was silent for too long
} energy;

typedef struct session_book {
	bool made, restarted; // restarted: the state after a restart is still to be compared
	bool full;            // the session's store refuses writes
	int64_t enabled_ns[TOOLS][CLIENTS]; // arrival of an enable that no cut has voided, or 0
	// the client drives in lock-step, where the clock does not measure its silence
	bool in_ticks[CLIENTS];
	bool by_ticks[TOOLS][CLIENTS]; // the enable came with a lock-step request
	int ticks_left[CLIENTS];       // ticks with energy that lock-step requests still allow
	// each command's number in the order of taking effect; 0: it never took effect
	int applied[GRAVITIES_MOST];
	bool acknowledged[GRAVITIES_MOST];
	int last_applied; // largest number in the order of taking effect
	int floor;        // order of the newest acknowledged command of the present branch; 0: none
	int line_from;    // order up to which a rewind may have removed the effect of commands
	bool leaving;     // a rewind is in progress
	int last_of_client[CLIENTS]; // gravity number of the client's last command that took effect
} session_book;

extern session_book sim_books[SESSIONS];

// The expensive requests of each client since a daemon's start.
typedef struct quota_book {
	int64_t from_ns;
	int done[CLIENTS];
} quota_book;

extern quota_book sim_quotas[DISK_MACHINES];

// Converts a command's number to a gravity, and a state's gravity back to the number.
double books_gravity(int number);
int books_number(double gravity); // 0 if no number has this gravity

energy promises_energy(int session, int tool, int64_t at_ns);
// Returns the client whose lock-step ticks are the only reason for the tool's energy. Returns -1 if
// there is another reason or no reason.
int promises_by_ticks(int session, int tool, int64_t at_ns);

// Notes that a rewind was requested (leaves), or that it has ended with or without success
// (arrives).
void books_line_leaves(session_book *book);
void books_line_arrives(session_book *book);
void books_acknowledge(session_book *book, int number);
// Notes that the daemon gives the core a new order, not a replayed one.
void books_apply(session_book *book, int number);
// Checks the state that a session has after a restart.
void books_compare(session_book *book, int place, int number);

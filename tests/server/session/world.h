// SPDX-License-Identifier: GPL-3.0-or-later
// A session's decisions in a world of two tools and three clients. Codes become events, acts and
// their outcomes, in any interleaving. After each of them an oracle (oracle.h) checks whether the
// decision was allowed.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "session/logic.h"

enum {
	TOOLS = 2,
	CLIENTS = 3, // clients 1 and 2 have the role operate, client 3 is an admin
	QUEUE = 6,
	TICKETS = 256,
	WORLD_WORKS = 20,    // with codes of at least this, modulo 32, the worker continues
	WORLD_ADVANCES = 28, // except that with this code, modulo 32, a client advances
};

#define DEADLINE_S 0.25      // deadline of every driver, s
enum { DEADLINE_TICKS = 4 }; // deadline in lock-step, ticks

// The oracle's knowledge of a tool.
typedef struct tool_book {
	bool there, energized; // `there`: the tool exists; `energized`: the core heats it
	int driver;            // number of the client; 0: none
	double deadline_s;
	uint64_t limit;  // tick at which the enable ends; 0: no limit
	uint64_t off;    // arrival of the newest event that turned energy off
	uint64_t enable; // arrival of the newest enable that the core took
	int enabler;
	double alive_s[CLIENTS + 1];
	uint64_t silent[CLIENTS + 1]; // arrival of the newest check that found this driver silent
	uint64_t looked;              // arrival of the newest check that the worker may have made
} tool_book;

typedef struct ticket_book {
	uint64_t came; // number of its arrival; 0: unused
	cau_asked asked;
	int answers;
	bool kept;     // false: the order was refused on arrival
	bool stepping; // its ticks are being computed
	bool voided;   // the order has become void: it must be refused
	bool doubted;  // the worker may have found silence: the order may be done or refused
} ticket_book;

typedef struct world {
	cau_logic *logic;
	cau_action action; // the worker's present act, until it is done
	cau_effects effects;
	double now_s;
	uint64_t came; // number of the newest arrival
	uint64_t away[CLIENTS + 1], gone[CLIENTS + 1];
	double life_s[CLIENTS + 1]; // newest sign of life, for any tool
	uint64_t paused; // arrival of the newest pause that waits outside the full queue; 0: none
	uint64_t served; // arrival of the pause that the worker is doing
	bool pausing;    // the worker makes the energy cut-offs of a pause
	uint64_t no_store;
	// Lock-step: its client, the tick of its advance, and the remaining ticks of the advance.
	int lockstep;
	uint64_t advance_tick;
	int64_t advance_left;
	int64_t steps_left; // remaining ticks of session.step
	// session.step or session.resume has ended lock-step, and this order is decided next
	bool leaving;
	bool store_takes, working, going, ended;
	uint64_t tick, going_since;
	int state;
	tool_book tools[TOOLS];
	ticket_book tickets[TICKETS];
	int ticket_count;
	uint64_t steps, energized_steps, energized_advances; // counts of what the tests have covered
	FILE *script;                                        // receives the events in words, or NULL
	char wrong[200];                                     // the first error; "": none
} world;

extern const char *const world_tool_names[TOOLS];
extern const char *const world_ask_names[CAU_ASK_COUNT];

// Notes an error, if there was none before.
__attribute__((format(printf, 2, 3))) void world_wrong(world *w, const char *format, ...);

world *world_create(void);
void world_destroy(world *w);
// Resets the world.
void world_begin(world *w);
// Carries out the code, if it has a meaning in this state. Returns false if there is an error in
// w->wrong.
bool world_do(world *w, uint32_t code);
// Ends the session. Each order must have had exactly one answer.
bool world_end(world *w);

// SPDX-License-Identifier: GPL-3.0-or-later
// A session's decisions in a world of two tools and three clients: bytes become events, acts and
// what comes of them, in any interleaving, and after each an oracle (oracle.h) is asked whether
// what happened may happen.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "session/logic.h"

enum {
	TOOLS = 2,
	CLIENTS = 3, // 1 and 2 may operate, 3 is an admin
	QUEUE = 6,
	TICKETS = 256,
	WORLD_WORKS = 20,    // what a code is, modulo 32, in which the worker goes on
	WORLD_ADVANCES = 28, // and in which somebody advances
};

#define DEADLINE_S 0.25      // of silence, of every driver
enum { DEADLINE_TICKS = 4 }; // in lock-step

// What the oracle knows of a tool.
typedef struct tool_book {
	bool there, lit; // in the core
	int driver;      // client; 0: nobody
	double deadline_s;
	uint64_t limit;  // tick at which the enable ends; 0: it has no limit
	uint64_t dark;   // coming in of the newest thing that darkens it
	uint64_t enable; // coming in of the newest enable that the core took
	int enabler;
	double alive_s[CLIENTS + 1];
	uint64_t silent[CLIENTS + 1]; // coming in of the newest look that found this driver silent
	uint64_t looked;              // of the newest one that the worker may have had
} tool_book;

typedef struct ticket_book {
	uint64_t came; // 0: there is none
	cau_asked asked;
	int answers;
	bool kept;     // it was not refused when it came in
	bool stepping; // session.step, which is under way
	bool voided;   // it was overtaken: it must be refused
	bool doubted;  // the worker may have looked for silence: either will do
} ticket_book;

typedef struct world {
	cau_logic *logic;
	cau_action action; // the worker's, until it is done
	cau_effects effects;
	double now_s;
	uint64_t came; // counts what comes in
	uint64_t away[CLIENTS + 1], gone[CLIENTS + 1];
	double life_s[CLIENTS + 1]; // newest sign of life, about whatever tool
	uint64_t paused; // coming in of the newest pause that found no room and waits; 0: none
	uint64_t served; // of the one that the worker is at
	bool pausing;    // the worker makes the cuts of a pause
	uint64_t no_store;
	// Lock-step: its client, since which tick, and the ticks of its advance that are left.
	int lockstep;
	uint64_t advance_tick;
	int64_t advance_left;
	int64_t steps_left; // of session.step
	bool leaving;       // by session.step or session.resume, which is decided next
	bool store_takes, working, going, ended;
	uint64_t tick, going_since;
	int state;
	tool_book tools[TOOLS];
	ticket_book tickets[TICKETS];
	int ticket_count;
	uint64_t steps, lit_steps, lit_advances; // how much was seen
	FILE *script;                            // the events in words, or NULL
	char wrong[200];                         // "": nothing
} world;

extern const char *const world_tool_names[TOOLS];
extern const char *const world_ask_names[CAU_ASK_COUNT];

// Notes what is wrong, if nothing was so far.
__attribute__((format(printf, 2, 3))) void world_wrong(world *w, const char *format, ...);

world *world_create(void);
void world_destroy(world *w);
// As new.
void world_begin(world *w);
// Does what `code` means here; does nothing where it means nothing. False: w->wrong says what is
// wrong.
bool world_do(world *w, uint32_t code);
// The session ends, and each order must have had its one answer.
bool world_end(world *w);

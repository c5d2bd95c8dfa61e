// SPDX-License-Identifier: GPL-3.0-or-later
// A session's machine in some 80 bytes: all that its decisions depend on and nothing else, so that
// two machines which will always answer alike are one state. Moments become places among the orders
// that are still to be decided, times become fresh or silent, ticks become how far ahead; names,
// causes and tickets are left out. A machine can be made of it again.
#pragma once

#include "session/logic.h"

enum { REACH_TOOLS = 2, REACH_CLIENTS = 2, REACH_QUEUE = 2 };

// Any time and tick will do: a state knows only what is fresh at `REACH_NOW_S` and what is silent,
// and what is wanted later than at `REACH_TICK`.
#define REACH_NOW_S 100.0
#define REACH_TICK_S 101.0 // when the next tick is due; who is fresh now is fresh then
#define REACH_DEADLINE_S 8.0
enum { REACH_TICK = 1000, REACH_STEP_TICKET = 60 };

typedef struct reach_order {
	uint8_t ask, client, tool, to;
	uint8_t fresh, cut, gone, to_gone; // cut: or a RESUME that was overtaken
	uint8_t later;                     // it is wanted so many ticks from now
	uint8_t looks;                     // it may be a resend, and was not looked for yet
	uint8_t postponed;                 // it is one, whose first is not on the disk yet
	uint8_t ticks;                     // STEP
	uint8_t overtaken; // the test's own: something that darkens its tool came in since
} reach_order;

typedef struct reach_tool {
	uint8_t driver, fresh, enabled, lit, freeze, by_order;
	uint8_t cut_place, lost_place, lost_client; // places in `orders`, from 1; 0: before all
	uint8_t heated;                             // the test's own: the core was told to heat it
	uint8_t wanted; // likewise: an enable of its driver counts, and the core took it
} reach_tool;

typedef struct reach_state {
	reach_tool tools[REACH_TOOLS];
	reach_order orders[REACH_QUEUE + 1]; // that which is served and those that wait, as they came
	uint8_t tool_count, capacity, order_count;
	uint8_t serves; // place in `orders` of the one that is served; 0: none
	uint8_t looks;  // of the one that is looked for, which waits
	uint8_t state, going, draining, ended, store_takes, acting, cutting;
	uint8_t steps_left, stepping;
	uint8_t pause_place;  // 1 + orders before a pause that found no room; 0: there is none
	uint8_t border_place; // 1 + orders that the border takes; 0: no border
	uint8_t held;         // the test's own: the newest of pause and resume is a pause
	uint8_t steps;        // likewise: ticks that session.step still has to make
} reach_state;

extern const char *const reach_tool_names[REACH_TOOLS];

cau_asker reach_asker(int client); // the last one is an admin
int reach_tool_index(const char *name);
bool reach_is_fresh(double alive_s, double now_s);
// `logic` has room for REACH_QUEUE orders. Tickets are places in `orders`.
void reach_decode(const reach_state *state, cau_logic *logic);
// All but the test's own books, which are taken from `books`; its orders are those of the machine.
void reach_encode(const cau_logic *logic, const reach_state *books, reach_state *state);
// The same with the two tools in each other's place.
void reach_swap_tools(const reach_state *state, reach_state *swapped);

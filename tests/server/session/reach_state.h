// SPDX-License-Identifier: GPL-3.0-or-later
// A session's machine in 16 bytes: all that its decisions depend on and nothing else, so that
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
#define REACH_STEP_S REACH_DEADLINE_S // so in lock-step a deadline is a tick
enum { REACH_ON = 1, REACH_OFF };

// The members of what follows and how many bits each takes where states are kept, which are many.
#define REACH_ORDER_MEMBERS(X)                                                                     \
	X(ask, 5)                                                                                      \
	X(client, 2)                                                                                   \
	X(tool, 1)                                                                                     \
	X(to, 2) /* ADVANCE: what it does to its tool's energy, REACH_ON or REACH_OFF */               \
	X(fresh, 1)                                                                                    \
	X(cut, 1) /* or a RESUME that was overtaken */                                                 \
	X(gone, 1)                                                                                     \
	X(to_gone, 1)                                                                                  \
	X(later, 1)     /* it is wanted so many ticks from now */                                      \
	X(looks, 1)     /* it may be a resend, and was not looked for yet */                           \
	X(postponed, 1) /* it is one, whose first is not on the disk yet */                            \
	X(ticks, 2)     /* STEP, ADVANCE */                                                            \
	X(overtaken, 1) /* the test's own: something that darkens its tool came in since */

#define REACH_TOOL_MEMBERS(X)                                                                      \
	X(driver, 2)                                                                                   \
	X(fresh, 1)                                                                                    \
	X(enabled, 1)                                                                                  \
	X(lit, 1)                                                                                      \
	X(freeze, 1)                                                                                   \
	X(by_order, 1)                                                                                 \
	X(cut_place, 2) /* places in `orders`, from 1; 0: before all */                                \
	X(heated, 1)    /* the test's own: the core was told to heat it */                             \
	X(wanted, 1)    /* likewise: an enable of its driver counts, and the core took it */

#define REACH_TIME_MEMBERS(X)                                                                      \
	X(tool_count, 2)                                                                               \
	X(capacity, 2)                                                                                 \
	X(order_count, 2)                                                                              \
	X(serves, 2) /* place in `orders` of the one that is served; 0: none */                        \
	X(looks, 2)  /* of the one that is looked for, which waits */                                  \
	X(state, 3)                                                                                    \
	X(going, 1)                                                                                    \
	X(draining, 1)                                                                                 \
	X(ended, 1)                                                                                    \
	X(store_takes, 1)                                                                              \
	X(acting, 4)                                                                                   \
	X(cutting, 1)                                                                                  \
	X(steps_left, 2)                                                                               \
	X(stepping, 1)                                                                                 \
	X(pause_place, 3)  /* 1 + orders before a pause that found no room; 0: there is none */        \
	X(border_place, 3) /* 1 + orders that the border takes; 0: no border */                        \
	X(held, 1)         /* the test's own: the newest of pause and resume is a pause */             \
	X(steps, 2)        /* likewise: ticks that session.step or an advance still has to make */     \
	X(lockstep, 2)     /* client */                                                                \
	X(since, 1)        /* a tick was made since its advance: as many as its deadline has */

#define REACH_MEMBER(name, bits) uint8_t name;
typedef struct reach_order {
	REACH_ORDER_MEMBERS(REACH_MEMBER)
} reach_order;

typedef struct reach_tool {
	REACH_TOOL_MEMBERS(REACH_MEMBER)
} reach_tool;

typedef struct reach_state {
	reach_tool tools[REACH_TOOLS];
	reach_order orders[REACH_QUEUE + 1]; // that which is served and those that wait, as they came
	REACH_TIME_MEMBERS(REACH_MEMBER)
} reach_state;
#undef REACH_MEMBER

// A state as it is kept.
typedef struct reach_packed {
	uint64_t word[2];
} reach_packed;

extern const char *const reach_tool_names[REACH_TOOLS];

const cau_asker *reach_asker(int client); // the last one is an admin; 0: no client
int reach_tool_index(const char *name);
bool reach_is_fresh(double alive_s, double now_s);
// `logic` has room for REACH_QUEUE orders. Tickets are places in `orders`.
void reach_decode(const reach_state *state, cau_logic *logic);
// Copies all but the drives and orders beyond their counts, which have no meaning.
void reach_copy_machine(const cau_logic *from, cau_logic *to);
// All but the test's own books, which are taken from `books`; its orders are those of the machine.
void reach_encode(const cau_logic *logic, const reach_state *books, reach_state *state);
// The same with the two tools in each other's place.
void reach_swap_tools(const reach_state *state, reach_state *swapped);
// Every bit of it; a member that is beyond its bits stops the test.
void reach_pack(const reach_state *state, reach_packed *packed);
void reach_unpack(const reach_packed *packed, reach_state *state);

// SPDX-License-Identifier: GPL-3.0-or-later
// A session's machine in 16 bytes. The bytes hold everything that the machine's decisions depend
// on, and nothing else, so machines with equal behaviour are one state. A moment becomes a place
// among the orders that are not decided yet. A time becomes fresh or silent, and a tick becomes its
// distance from the present tick. Names, causes and tickets are left out. A state can be decoded
// into a machine again.
#pragma once

#include "session/logic.h"

enum { REACH_TOOLS = 2, REACH_CLIENTS = 2, REACH_QUEUE = 2 };

// Arbitrary values of a present time, s, and a present tick. A state only stores which times are
// fresh at REACH_NOW_S, and which orders are for a tick after REACH_TICK.
#define REACH_NOW_S 100.0
// time of the next tick, s; a driver that is fresh now is still fresh at this time
#define REACH_TICK_S 101.0
#define REACH_DEADLINE_S 8.0
enum { REACH_TICK = 1000, REACH_STEP_TICKET = 60 };
// length of a tick, s; in lock-step, a deadline then has the length of one tick
#define REACH_STEP_S REACH_DEADLINE_S
enum { REACH_ON = 1, REACH_OFF };

// The members of the structs below, and the bits of each member in a packed state. Searches keep
// many packed states.
#define REACH_ORDER_MEMBERS(X)                                                                     \
	X(ask, 5)                                                                                      \
	X(client, 2)                                                                                   \
	X(tool, 1)                                                                                     \
	X(to, 2) /* ADVANCE: its tool's energy, REACH_ON or REACH_OFF */                               \
	X(fresh, 1)                                                                                    \
	X(cut, 1) /* void; or a RESUME before a later pause */                                         \
	X(gone, 1)                                                                                     \
	X(to_gone, 1)                                                                                  \
	X(later, 1)     /* number of ticks from now at which it takes effect */                        \
	X(looks, 1)     /* may be a resend; the store was not searched yet */                          \
	X(postponed, 1) /* a resend; the earlier order is not on the disk yet */                       \
	X(ticks, 2)     /* of STEP and ADVANCE */                                                      \
	X(overtaken, 1) /* the test's own: a later event turned its tool's energy off */

#define REACH_TOOL_MEMBERS(X)                                                                      \
	X(driver, 2)                                                                                   \
	X(fresh, 1)                                                                                    \
	X(enabled, 1)                                                                                  \
	X(energized, 1)                                                                                \
	X(freeze, 1)                                                                                   \
	X(by_order, 1)                                                                                 \
	X(cut_place, 2) /* place in `orders`, from 1; 0: before all */                                 \
	X(heated, 1)    /* the test's own: the core heats the tool */                                  \
	X(wanted, 1)    /* the test's own: the core took an enable of its driver that counts */

#define REACH_TIME_MEMBERS(X)                                                                      \
	X(tool_count, 2)                                                                               \
	X(capacity, 2)                                                                                 \
	X(order_count, 2)                                                                              \
	X(serves, 2) /* place in `orders` of the order being served; 0: none */                        \
	X(looks, 2)  /* place of the waiting order whose earlier answer is searched */                 \
	X(state, 3)                                                                                    \
	X(going, 1)                                                                                    \
	X(draining, 1)                                                                                 \
	X(ended, 1)                                                                                    \
	X(store_takes, 1)                                                                              \
	X(acting, 4)                                                                                   \
	X(cutting, 1)                                                                                  \
	X(steps_left, 2)                                                                               \
	X(stepping, 1)                                                                                 \
	X(pause_place, 3)  /* 1 + orders before a pause outside the full queue; 0: none */             \
	X(border_place, 3) /* 1 + orders that this border serves; 0: no border */                      \
	X(held, 1)         /* the test's own: a pause is newer than any resume */                      \
	X(steps, 2)        /* the test's own: remaining ticks of session.step or an advance */         \
	X(lockstep, 2)     /* number of the client; 0: none */                                         \
	X(since, 1)        /* a tick has begun since its advance, as many as its deadline has */

#define REACH_MEMBER(name, bits) uint8_t name;
typedef struct reach_order {
	REACH_ORDER_MEMBERS(REACH_MEMBER)
} reach_order;

typedef struct reach_tool {
	REACH_TOOL_MEMBERS(REACH_MEMBER)
} reach_tool;

typedef struct reach_state {
	reach_tool tools[REACH_TOOLS];
	// the order being served and the waiting orders, in order of arrival
	reach_order orders[REACH_QUEUE + 1];
	REACH_TIME_MEMBERS(REACH_MEMBER)
} reach_state;
#undef REACH_MEMBER

// A packed state.
typedef struct reach_packed {
	uint64_t word[2];
} reach_packed;

extern const char *const reach_tool_names[REACH_TOOLS];

const cau_asker *reach_asker(int client); // the last client is an admin; 0: no client
int reach_tool_index(const char *name);
bool reach_is_fresh(double alive_s, double now_s);
// Decodes a state into a machine. `logic` has capacity for REACH_QUEUE orders. Tickets are places
// in `orders`.
void reach_decode(const reach_state *state, cau_logic *logic);
// Copies everything except drives and orders beyond their counts, which have no meaning.
void reach_copy_machine(const cau_logic *from, cau_logic *to);
// Encodes a machine as a state. The test's own books are copied from `books`, whose orders are
// those of the machine.
void reach_encode(const cau_logic *logic, const reach_state *books, reach_state *state);
// Copies the state with the two tools exchanged.
void reach_swap_tools(const reach_state *state, reach_state *swapped);
// Packs all members. A value that exceeds its bits stops the test.
void reach_pack(const reach_state *state, reach_packed *packed);
void reach_unpack(const reach_packed *packed, reach_state *state);

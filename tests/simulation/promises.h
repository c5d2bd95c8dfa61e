// SPDX-License-Identifier: GPL-3.0-or-later
// The promises of protocol/README.md, as the simulation checks them. The checks see what clients
// send and receive, and the inputs of the test double of the core. They do not trust the daemon's
// own records.
#pragma once

#include <stdint.h>

#include "simulation/network.h"
#include "simulation/world.h"

// Columns: word, promise.
#define PROMISE_TABLE(X)                                                                           \
	X(energy_cut, "no tick that begins after a cut is computed with energy")                       \
	X(energy_silent, "energy goes off when its driver is silent, within a tick")                   \
	X(energy_restart, "a restart comes up with energy off")                                        \
	X(energy_full, "while the store is full energy is off")                                        \
	X(one_answer, "a request gets one answer")                                                     \
	X(answered, "a request gets its answer in time")                                               \
	X(acknowledged, "what was acknowledged is there after a kill and a loss of power")             \
	X(once, "a request that is sent again acts once")                                              \
	X(same_answer, "a request that is sent again gets the first answer")                           \
	X(allowed, "a token does what its role, its sessions and its quota allow, and sees no more")   \
	X(order, "commands of a connection take effect in the order sent")                             \
	X(one_server, "at most one daemon serves a session")                                           \
	X(budget, "queues, sessions and bytes in flight have the stated bounds")                       \
	X(fair, "a session keeps its pace whatever others do")                                         \
	X(stream, "frames lead to the daemon's state")                                                 \
	X(sound, "no session is faulted, no client closed, without a cause")                           \
	X(up, "a daemon starts again on what its disk kept, and its sessions with it")                 \
	X(progress, "some thread can go on")                                                           \
	X(locks, "locks are given back by who took them")                                              \
	X(crash, "the daemon does not crash")

void promises_begin(const sim_profile *profile);
const char *promises_meaning(const char *word); // NULL if there is no such promise

// ---- seen by clients (clients.c)
void promises_arriving(uint64_t number); // the daemon is about to read the request
void promises_arrived(uint64_t number);  // the daemon has read the request
void promises_answered(uint64_t number);
// the daemon knows that the client's page is hidden or its connection has ended
void promises_away(int client);
// The source daemon has decided: from now on the session belongs to the target daemon.
void promises_moving(int session, int target);
void promises_told(int client, const char *text);

// the daemon has notified the session whether its store accepts writes
void promises_store_takes(const char *id, bool takes);

// ---- events of daemons (daemons.c)
void promises_killed(int machine); // the daemon was killed, or has ended in order
void promises_started(int machine);

// ---- end of a run
// From now on everything works, so all requests must be answered in time.
void promises_calm(void);
void promises_settled(void); // checks the state after promises_calm

typedef struct promise_counts {
	uint64_t ticks, energized_ticks, cuts_seen, answers, acknowledged, restarts, frames, replays,
		checks, moves;
} promise_counts;
extern promise_counts promises_counted;

// SPDX-License-Identifier: GPL-3.0-or-later
// A session among threads: clients that send requests, threads that cause losses, the worker that
// steps, and the store that commits. The double checks the tools of each tick. A tool must be
// energized exactly if that was decided when the tick began, and never by an enable from before a
// loss.
#pragma once

#include "hosted_session/internal.h"

enum {
	CLIENTS = 2,
	TOOLS = 2,
	ROUNDS = 1500, // number of requests of each client
	REQUESTS = 2 * CLIENTS * ROUNDS + 512,
	// most unanswered requests of a client; the core's queue also holds the cut-offs between two
	// ticks
	IN_FLIGHT = 4,
};

// A moment on the way of an enable through the session.
typedef enum moment {
	NOWHERE,
	WAITING,    // between the enable's arrival and its application
	TAKEN,      // while the core takes the enable
	APPLIED,    // between the enable's application and the tick
	COMMITTING, // while the enable's row is being written
	STEPPING,   // within the tick that the enable heats
	MOMENT_COUNT
} moment;

typedef enum loss { CUT, FORGET, FULL_STORE, OFF_BY_ANOTHER, LOSS_COUNT } loss;

typedef struct request {
	atomic_int answers;
	atomic_bool failed;
	int client;
} request;

// A tool's energy, as the notifications to clients report it.
typedef struct tool_book {
	bool on;
	uint64_t on_from, off_from; // ticks from which energy is on and off
	uint64_t asked;             // number of the newest enable that the core took
	uint64_t energized_ticks;
} tool_book;

// The client's enables up to this number heat no tick from `from_tick` on.
typedef struct loss_mark {
	uint64_t asked, from_tick;
} loss_mark;

typedef struct threads_world {
	char folder[40], file[64];
	cau_config config;
	cau_store *store;
	_Atomic int64_t memory_held;
	cau_beginnings beginnings;
	cau_surroundings around;
	_Atomic(cau_hosted *) h;
	request requests[REQUESTS];
	atomic_int request_count;
	// A meeting: the thread that reaches the moment waits while another thread causes the loss.
	atomic_int wanted; // the moment at which the next thread waits
	pthread_barrier_t met, over;
	atomic_bool ended;
	_Atomic uint64_t asked[CLIENTS]; // number of the client's newest enable that arrived
	// Guarded by the lock, which may be taken inside the session's lock.
	pthread_mutex_t lock;
	pthread_cond_t changed;
	tool_book tools[TOOLS];
	loss_mark marks[CLIENTS];
	uint64_t steps, answered, wrongs;
	int in_flight[CLIENTS];
	bool full; // the session was notified that the store is full
	char wrong[160];
} threads_world;

extern threads_world threads;

// Setup and teardown for cmocka.
int threads_begin(void **state);
int threads_end(void **state);

// ---- requests of `client`; the caller may wait for the returned request
request *threads_ask(int client, cau_order_kind kind, cau_method method, int tool);
request *threads_take_over(int client, int tool);
request *threads_energize(int client, int tool, bool on);
void threads_move(int client, int tool, double x_m);

// Waits for the answer. Returns true if the request succeeded.
bool threads_done(request *r);
void threads_await_answers(void); // waits for the answers to all requests
void threads_await_steps(uint64_t count);

// Causes a loss. Requests of the client from before the loss heat no tick that begins later.
void threads_lose(loss kind, int client);

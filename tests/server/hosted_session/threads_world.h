// SPDX-License-Identifier: GPL-3.0-or-later
// The world of a session among threads: those that ask, those that bring losses, the worker that
// steps and the store that commits. The double's step looks at each tick's tools: lit is what was
// decided when the tick began, and nothing that was asked for before a loss.
#pragma once

#include "hosted_session/internal.h"

enum {
	CLIENTS = 2,
	TOOLS = 2,
	ROUNDS = 1500, // of each client
	REQUESTS = 2 * CLIENTS * ROUNDS + 512,
	IN_FLIGHT = 4, // of a client; with the cuts between two ticks the core's queue holds them
};

// Of an enable's way through the session.
typedef enum moment {
	NOWHERE,
	WAITING,    // between its coming in and its application
	TAKEN,      // while the core takes it
	APPLIED,    // between its application and the tick
	COMMITTING, // while its row is written
	STEPPING,   // within the tick that it heats
	MOMENT_COUNT
} moment;

typedef enum loss { CUT, FORGET, FULL_STORE, OFF_BY_ANOTHER, LOSS_COUNT } loss;

typedef struct request {
	atomic_int answers;
	atomic_bool failed;
	int client;
} request;

// What is known of a tool's energy, from what everybody is told of it.
typedef struct tool_book {
	bool on;
	uint64_t lit_from, dark_from; // ticks
	uint64_t asked;               // number of the newest enable that the core took
	uint64_t lit_ticks;
} tool_book;

// Enables of a client up to this number heat no tick from this one on.
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
	// Meeting: the thread that comes to the moment waits while another brings the loss.
	atomic_int wanted; // moment
	pthread_barrier_t met, over;
	atomic_bool ended;
	_Atomic uint64_t asked[CLIENTS]; // newest enable that came in, by its number
	// Guarded by the lock, which is taken within the session's.
	pthread_mutex_t lock;
	pthread_cond_t changed;
	tool_book tools[TOOLS];
	loss_mark marks[CLIENTS];
	uint64_t steps, answered, wrongs;
	int in_flight[CLIENTS];
	bool full; // the store, as the session was told
	char wrong[160];
} threads_world;

extern threads_world threads;

// A setup and a teardown of cmocka.
int threads_begin(void **state);
int threads_end(void **state);

// ---- what is asked, as from `client`; whoever wants to know awaits the request
request *threads_ask(int client, cau_order_kind kind, cau_method method, int tool);
request *threads_take_over(int client, int tool);
request *threads_energize(int client, int tool, bool on);
void threads_move(int client, int tool, double x_m);

// Awaits the answer: whether it was granted.
bool threads_done(request *r);
void threads_await_answers(void); // to all requests
void threads_await_steps(uint64_t count);

// Brings a loss: what was asked for before it heats no tick that begins from now on.
void threads_lose(loss kind, int client);

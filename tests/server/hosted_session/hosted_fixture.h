// SPDX-License-Identifier: GPL-3.0-or-later
// A session and its surroundings. A test can stop the builder between two stages, or before the
// core restores a snapshot. A test can also stop the store before it writes.
#pragma once

#include "hosted_session/internal.h"

enum {
	NOWHERE = -1,
	AT_RESTORE = CAU_BUILD_STAGE_COUNT + 1, // before the core restores a snapshot
	CREATOR = 7,
	ANSWERS = 9,
};

typedef struct hosted_answer {
	int count;
	cau_status status;
	int32_t code;
	char reason[320];
	char text[1000];
} hosted_answer;

typedef struct hosted_fixture {
	char folder[40], file[64];
	cau_config config;
	_Atomic int64_t memory_held;
	cau_beginnings beginnings;
	cau_surroundings around;
	cau_hosted *h;
	atomic_int held_at; // where the builder stops: a border between two stages, or AT_RESTORE
	pthread_barrier_t met, over;
	atomic_bool hold_commit;
	pthread_barrier_t committing, commit;
	pthread_mutex_t lock;
	pthread_cond_t answered;
	hosted_answer answers[ANSWERS]; // the creator's answer is the first
	atomic_bool fail_restore;       // makes the next restore fail
} hosted_fixture;

extern hosted_fixture t;

// Run before and after each test. Closing fails if a session has not returned memory that it held.
int hosted_open_surroundings(void **state);
int hosted_close_surroundings(void **state);
cau_scene_def *hosted_make_scene(void);
cau_reply hosted_reply_to(int asked, cau_method method);
// Begins to build a paused session. The builder stops at the border `held_at`.
void hosted_begin(int held_at, int creation);
void hosted_go_on(void);
const hosted_answer *hosted_await(int asked);
cau_order *hosted_new_order(int asked, cau_order_kind kind, cau_method method);
void hosted_submit(cau_order *order);
void hosted_destroy(int asked, int64_t client_sequence);
// Submits an order that waits for tick 1000, which never comes.
void hosted_turn_off_at_tick_1000(int asked);
// Stops the session as the hub does, and releases the last reference to it.
void hosted_let_go(void);
int hosted_stored_sessions(void);
int hosted_stored_answers(uint64_t client_sequence);

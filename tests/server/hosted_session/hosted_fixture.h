// SPDX-License-Identifier: GPL-3.0-or-later
// A session and what is around it, whose builder stands still where a test wants it to: between two
// stages, or before the core takes a snapshot. So does the store before it writes.
#pragma once

#include "hosted_session/internal.h"

enum {
	NOWHERE = -1,
	AT_RESTORE = CAU_BUILD_STAGE_COUNT + 1, // before the core takes a snapshot
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
	atomic_int held_at; // border between two stages, or AT_RESTORE
	pthread_barrier_t met, over;
	atomic_bool hold_commit;
	pthread_barrier_t committing, commit;
	pthread_mutex_t lock;
	pthread_cond_t answered;
	hosted_answer answers[ANSWERS]; // the creator's first
	atomic_bool fail_restore;       // the next one
} hosted_fixture;

extern hosted_fixture t;

// Around each test. Closing fails if a session left something that it held.
int hosted_open_surroundings(void **state);
int hosted_close_surroundings(void **state);
cau_scene_def *hosted_make_scene(void);
cau_reply hosted_reply_to(int asked, cau_method method);
// Begins to build a session, paused, which stands still at the border.
void hosted_begin(int held_at, int creation);
void hosted_go_on(void);
const hosted_answer *hosted_await(int asked);
cau_order *hosted_new_order(int asked, cau_order_kind kind, cau_method method);
void hosted_submit(cau_order *order);
void hosted_destroy(int asked, int64_t client_sequence);
// One that waits in the queue for a tick that does not come.
void hosted_turn_off_at_tick_1000(int asked);
// The session is out of the hub's list, and its last holder lets it go.
void hosted_let_go(void);
int hosted_stored_sessions(void);
int hosted_stored_answers(uint64_t client_sequence);

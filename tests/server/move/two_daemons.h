// SPDX-License-Identifier: GPL-3.0-or-later
// The hubs and moves of two daemons in one process, on the double of the core, and a courier. The
// courier moves `d1-knee` of the source to the target, where its id is `d2-knee`.
#pragma once

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "move/courier.h"
#include "move/move.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, open_both, close_both)

enum { PIECES_MOST = 64 }; // most pieces that a test carries; a small session takes two

typedef struct side {
	char folder[40], file[64];
	cau_config config;
	cau_store *store;
	cau_worker_pool *pool;
	cau_builder *builder, *mover;
	cau_hub *hub;
	cau_moves *moves;
} side;

// The answer to the newest request.
typedef struct answer {
	bool came;
	cau_status status;
	int32_t code;
	char reason[320], text[2000];
	unsigned char *file; // malloc'ed
	size_t file_bytes;
} answer;

typedef struct two_daemons {
	side source, target;
	pthread_mutex_t lock;
	pthread_cond_t answered;
	answer answer;
	answer held; // answer to a request that is stopped at a fault point while other requests come
	char move[CAU_NAME_BYTES];
	uint32_t pieces;     // number of pieces that were carried
	cau_move_hash seal;  // seal of the last carried piece
	unsigned char *last; // bytes of the last carried piece; malloc'ed
	size_t last_bytes;
} two_daemons;

extern two_daemons t;

int open_both(void **state);
int close_both(void **state); // first opens the gate

// ---- fault points
//   A thread that reaches the fault point of this name waits there. NULL: no thread waits.
void set_gate(const char *name);
void await_gate(void); // waits until a thread has reached the gate

// ---- requests and answers
cau_reply reply_to(answer *a, cau_method method);
cau_status await(const answer *a);
bool is_answered(const answer *a);
// Waits until only `held` requests remain, all stopped at a fault point.
void await_mover(side *s, int held);
cau_status make_session(side *s, const char *name);
// Sends a request about the move, without waiting for the answer.
void send_request(side *s, cau_move_asked asked, cau_method method, answer *a);
cau_status ask(side *s, cau_move_asked asked, cau_method method);
#define ASK_WITH(side, NAME, ...)                                                                  \
	ask(&t.side, (cau_move_asked){.what = CAU_MOVE_##NAME, __VA_ARGS__}, CAU_METHOD_MOVE_##NAME)
#define ASK(side, NAME) ASK_WITH(side, NAME, .piece = NULL)

void read_result(cau_method method, void *result);
bool serves(side *s, const char *id);

// ---- the courier's steps
void begin_move(void);
// Carries the next piece. Returns false if the source gives none now.
bool carry_piece(cau_wire_move_received *received);
void carry_part(void);
void hold_and_carry_rest(char receipt[CAU_PROOF_BYTES]);
void commit(const char *receipt, char proof[CAU_PROOF_BYTES]);
// Sends a key to the target.
cau_status show(cau_move_what what, cau_method method, const char *key);

// SPDX-License-Identifier: GPL-3.0-or-later
// Two daemons' hubs and moves in one process, on the double of the core, and a courier between
// them: it moves `d1-knee` of the source to the target, where it is `d2-knee`.
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

enum { PIECES_MOST = 64 }; // a small session takes two

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
	answer held; // to a request that is held at a fault point while others come
	char move[CAU_NAME_BYTES];
	uint32_t pieces;     // that were carried
	cau_move_hash seal;  // of the last of them
	unsigned char *last; // its bytes, malloc'ed
	size_t last_bytes;
} two_daemons;

extern two_daemons t;

int open_both(void **state);
int close_both(void **state); // opens the gate first

// ---- fault points: the thread that comes to the one of this name waits there. NULL: none waits.
void set_gate(const char *name);
void await_gate(void); // until a thread waits

// ---- requests and answers
cau_reply reply_to(answer *a, cau_method method);
cau_status await(const answer *a);
bool is_answered(const answer *a);
// Until only so many requests are under way, held at a fault point.
void await_mover(side *s, int held);
cau_status make_session(side *s, const char *name);
// Asks about the move, and does not wait for the answer.
void send_request(side *s, cau_move_asked asked, cau_method method, answer *a);
cau_status ask(side *s, cau_move_asked asked, cau_method method);
#define ASK_WITH(side, NAME, ...)                                                                  \
	ask(&t.side, (cau_move_asked){.what = CAU_MOVE_##NAME, __VA_ARGS__}, CAU_METHOD_MOVE_##NAME)
#define ASK(side, NAME) ASK_WITH(side, NAME, .piece = NULL)

void read_result(cau_method method, void *result);
bool serves(side *s, const char *id);

// ---- the courier's steps
void begin_move(void);
// Carries the next piece. False: the source gives none now.
bool carry_piece(cau_wire_move_received *received);
void carry_part(void);
void hold_and_carry_rest(char receipt[CAU_PROOF_BYTES]);
void commit(const char *receipt, char proof[CAU_PROOF_BYTES]);
// Shows the target a key.
cau_status show(cau_move_what what, cau_method method, const char *key);

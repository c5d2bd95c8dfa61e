// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/move/two_daemons.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "log/log.h"
#include "server/hub/small_creation.h"

two_daemons t;

// ---- fault points: a thread that reaches the shut point waits there
static struct {
	pthread_mutex_t lock;
	pthread_cond_t changed;
	const char *shut; // name of the shut fault point; NULL: none
	bool reached;
} gate = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};

void cau_fault_point(const char *name)
{
	pthread_mutex_lock(&gate.lock);
	while (gate.shut && strcmp(gate.shut, name) == 0) {
		gate.reached = true;
		pthread_cond_broadcast(&gate.changed);
		pthread_cond_wait(&gate.changed, &gate.lock);
	}
	pthread_mutex_unlock(&gate.lock);
}

void set_gate(const char *name)
{
	pthread_mutex_lock(&gate.lock);
	gate.shut = name;
	gate.reached = false;
	pthread_cond_broadcast(&gate.changed);
	pthread_mutex_unlock(&gate.lock);
}

void await_gate(void)
{
	pthread_mutex_lock(&gate.lock);
	while (!gate.reached)
		pthread_cond_wait(&gate.changed, &gate.lock);
	pthread_mutex_unlock(&gate.lock);
}

static void armed(void *user)
{
	(void)user;
}

// ---- two daemons
static int open_side(side *s, const char *label)
{
	cau_config_default(&s->config);
	snprintf(s->config.label, sizeof s->config.label, "%s", label);
	snprintf(s->folder, sizeof s->folder, "/tmp/cautery-moves-XXXXXX");
	if (!mkdtemp(s->folder))
		return -1;
	snprintf(s->file, sizeof s->file, "%s/store.db", s->folder);
	cau_store_config of_store = cau_store_default_config();
	of_store.path = s->file;
	of_store.label = s->config.label;
	of_store.commit_delay_ms = 0;
	if (cau_store_open(&of_store, &s->store, NULL) ||
	    cau_worker_pool_create(&s->pool, 1, 4, 0, NULL) ||
	    cau_builder_create(&s->builder, "cautery-build", 1, 0, NULL) ||
	    cau_builder_create(&s->mover, "cautery-move", 1, 0, NULL))
		return -1;
	cau_hub_def of_hub = {.config = &s->config,
	                      .store = s->store,
	                      .pool = s->pool,
	                      .builder = s->builder,
	                      .mover = s->mover,
	                      .armed = armed};
	if (cau_hub_create(&s->hub, &of_hub, NULL))
		return -1;
	cau_moves_def of_moves = {
		.config = &s->config, .store = s->store, .mover = s->mover, .hub = s->hub};
	return cau_moves_create(&s->moves, &of_moves, NULL) || cau_moves_resume(s->moves, NULL) ? -1
	                                                                                        : 0;
}

// Closes in the daemon's order.
static int close_side(side *s)
{
	cau_moves_drain(s->moves);
	cau_builder_stop(s->builder);
	cau_builder_stop(s->mover);
	cau_moves_stop(s->moves);
	cau_hub_stop(s->hub);
	cau_builder_destroy(s->builder);
	cau_builder_destroy(s->mover);
	cau_moves_destroy(s->moves);
	cau_hub_destroy(s->hub);
	cau_worker_pool_destroy(s->pool);
	cau_store_close(s->store);
	unlink(s->file);
	return rmdir(s->folder);
}

int open_both(void **state)
{
	(void)state;
	memset(&t, 0, sizeof t);
	pthread_mutex_init(&t.lock, NULL);
	pthread_cond_init(&t.answered, NULL);
	cau_log_set_level("error");
	return open_side(&t.source, "d1") || open_side(&t.target, "d2") ? -1 : 0;
}

int close_both(void **state)
{
	(void)state;
	set_gate(NULL);
	int failed = close_side(&t.source) | close_side(&t.target);
	free(t.answer.file);
	free(t.held.file);
	free(t.last);
	pthread_cond_destroy(&t.answered);
	pthread_mutex_destroy(&t.lock);
	return failed;
}

// ---- requests and answers
static void note_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	(void)reply;
	pthread_mutex_lock(&t.lock);
	answer *a = user;
	a->came = true;
	a->code = outcome->code;
	if (outcome->error) {
		a->status = outcome->error->status;
		snprintf(a->reason, sizeof a->reason, "%.319s", outcome->error->reason);
	} else {
		snprintf(a->text, sizeof a->text, "%.*s", (int)outcome->text_bytes, outcome->text);
	}
	if (outcome->file) {
		a->file_bytes = outcome->file->byte_count;
		a->file = malloc(a->file_bytes);
		memcpy(a->file, cau_buffer_bytes(outcome->file), a->file_bytes);
	}
	pthread_cond_broadcast(&t.answered);
	pthread_mutex_unlock(&t.lock);
}

cau_reply reply_to(answer *a, cau_method method)
{
	free(a->file);
	*a = (answer){0};
	return (cau_reply){.answer = note_answer, .user = a, .method = method};
}

cau_status await(const answer *a)
{
	pthread_mutex_lock(&t.lock);
	while (!a->came)
		pthread_cond_wait(&t.answered, &t.lock);
	pthread_mutex_unlock(&t.lock);
	return a->status;
}

bool is_answered(const answer *a)
{
	pthread_mutex_lock(&t.lock);
	bool came = a->came;
	pthread_mutex_unlock(&t.lock);
	return came;
}

// Waits until only `held` requests remain, all stopped at a fault point.
void await_mover(side *s, int held)
{
	while (cau_builder_busy(s->mover) > held)
		usleep(1000);
}

cau_status make_session(side *s, const char *name)
{
	cau_reply reply = reply_to(&t.answer, CAU_METHOD_SESSION_CREATE);
	cau_hub_submit_creation(s->hub, small_creation(name, reply));
	return await(&t.answer);
}

void send_request(side *s, cau_move_asked asked, cau_method method, answer *a)
{
	snprintf(asked.session, sizeof asked.session, "%s", s == &t.source ? "d1-knee" : "d2-knee");
	if (asked.what != CAU_MOVE_BEGIN)
		memcpy(asked.move, t.move, sizeof asked.move);
	cau_reply reply = reply_to(a, method);
	assert_int_equal(cau_moves_ask(s->moves, &asked, &reply, NULL), CAU_OK);
}

cau_status ask(side *s, cau_move_asked asked, cau_method method)
{
	send_request(s, asked, method, &t.answer);
	return await(&t.answer);
}

void read_result(cau_method method, void *result)
{
	cau_rpc_message message;
	cau_rpc_fault fault;
	size_t bytes = strlen(t.answer.text);
	assert_int_equal(cau_rpc_read(t.answer.text, bytes, bytes, &message, &fault), 0);
	assert_int_equal(cau_rpc_result(&message, method, result, NULL), CAU_OK);
	cau_rpc_finish(&message);
}

// Copies the key of an answer.
static void take_key(char key[CAU_PROOF_BYTES], bool given, const char *text)
{
	assert_true(given);
	snprintf(key, CAU_PROOF_BYTES, "%s", text);
}

bool serves(side *s, const char *id)
{
	cau_hosted *hosted = cau_hub_find(s->hub, id);
	cau_hosted_release(hosted);
	return hosted != NULL;
}

// ---- the courier's steps
void begin_move(void)
{
	cau_wire_move_begun begun = {0};
	cau_move_asked asked = {.what = CAU_MOVE_BEGIN, .label = "d2", .to.session = "d2-knee"};
	assert_int_equal(make_session(&t.source, "knee"), CAU_OK);
	assert_int_equal(ask(&t.source, asked, CAU_METHOD_MOVE_BEGIN), CAU_OK);
	read_result(CAU_METHOD_MOVE_BEGIN, &begun);
	memcpy(t.move, begun.move, sizeof t.move);
}

// Carries the next piece. Returns false if the source gives none now.
bool carry_piece(cau_wire_move_received *received)
{
	if (ASK(source, READ))
		return false;
	unsigned char *piece = t.answer.file;
	size_t bytes = t.answer.file_bytes;
	t.answer.file = NULL;
	t.pieces++;
	free(t.last);
	t.last = malloc(bytes);
	t.last_bytes = bytes;
	memcpy(t.last, piece, bytes);
	memcpy(t.seal, piece + bytes - CAU_SEAL_BYTES, CAU_SEAL_BYTES);
	assert_int_equal(ASK_WITH(target, RECEIVE, .piece = piece, .piece_bytes = bytes), CAU_OK);
	*received = (cau_wire_move_received){0};
	read_result(CAU_METHOD_MOVE_RECEIVE, received);
	return true;
}

void carry_part(void)
{
	int pieces = 0;
	cau_wire_move_received received = {0};
	while (pieces < PIECES_MOST && carry_piece(&received))
		pieces++;
	// the remaining pieces are sent once the session is suspended
	assert_int_equal(t.answer.status, CAU_BAD_STATE);
	assert_in_range(pieces, 1, PIECES_MOST - 1);
	assert_false(received.has_receipt);
}

void hold_and_carry_rest(char receipt[CAU_PROOF_BYTES])
{
	cau_wire_move_received received = {0};
	assert_int_equal(ASK(source, HOLD), CAU_OK);
	for (int pieces = 0; pieces < PIECES_MOST && !received.has_receipt; pieces++)
		assert_true(carry_piece(&received));
	take_key(receipt, received.has_receipt, received.receipt);
}

void commit(const char *receipt, char proof[CAU_PROOF_BYTES])
{
	cau_wire_move_decision decision = {0};
	cau_move_asked asked = {.what = CAU_MOVE_COMMIT};
	snprintf(asked.key, sizeof asked.key, "%s", receipt);
	assert_int_equal(ask(&t.source, asked, CAU_METHOD_MOVE_COMMIT), CAU_OK);
	read_result(CAU_METHOD_MOVE_COMMIT, &decision);
	assert_true(decision.moved);
	take_key(proof, decision.has_proof, decision.proof);
}

cau_status show(cau_move_what what, cau_method method, const char *key)
{
	cau_move_asked asked = {.what = what};
	snprintf(asked.key, sizeof asked.key, "%s", key);
	return ask(&t.target, asked, method);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Two daemons' hubs and moves in one process, on the double of the core, and a courier between
// them. Who may be killed when: tests/e2e/move.test.mjs.
#include "move/move.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "log/log.h"
#include "move/courier.h"
#include "server/hub/small_creation.h"

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

static struct {
	side source, target;
	pthread_mutex_t lock;
	pthread_cond_t answered;
	answer answer;
	char move[CAU_NAME_BYTES];
} t;

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

// In the daemon's order.
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

static int open_both(void **state)
{
	(void)state;
	memset(&t, 0, sizeof t);
	pthread_mutex_init(&t.lock, NULL);
	pthread_cond_init(&t.answered, NULL);
	cau_log_set_level("error");
	return open_side(&t.source, "d1") || open_side(&t.target, "d2") ? -1 : 0;
}

static int close_both(void **state)
{
	(void)state;
	int failed = close_side(&t.source) | close_side(&t.target);
	free(t.answer.file);
	pthread_cond_destroy(&t.answered);
	pthread_mutex_destroy(&t.lock);
	return failed;
}

// ---- requests and answers
static void note_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	(void)user, (void)reply;
	pthread_mutex_lock(&t.lock);
	answer *a = &t.answer;
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

static cau_reply next_reply(cau_method method)
{
	free(t.answer.file);
	t.answer = (answer){0};
	return (cau_reply){.answer = note_answer, .method = method};
}

static cau_status await(void)
{
	pthread_mutex_lock(&t.lock);
	while (!t.answer.came)
		pthread_cond_wait(&t.answered, &t.lock);
	pthread_mutex_unlock(&t.lock);
	return t.answer.status;
}

static cau_status make_session(side *s, const char *name)
{
	cau_reply reply = next_reply(CAU_METHOD_SESSION_CREATE);
	cau_hub_submit_creation(s->hub, small_creation(name, reply));
	return await();
}

static cau_status ask(side *s, cau_move_asked asked, cau_method method)
{
	snprintf(asked.session, sizeof asked.session, "%s", s == &t.source ? "d1-knee" : "d2-knee");
	if (asked.what != CAU_MOVE_BEGIN)
		memcpy(asked.move, t.move, sizeof asked.move);
	cau_reply reply = next_reply(method);
	assert_int_equal(cau_moves_ask(s->moves, &asked, &reply, NULL), CAU_OK);
	return await();
}

#define ASK(side, NAME, ...)                                                                       \
	ask(&t.side, (cau_move_asked){.what = CAU_MOVE_##NAME, __VA_ARGS__}, CAU_METHOD_MOVE_##NAME)

static void read_result(cau_method method, void *result)
{
	cau_rpc_message message;
	cau_rpc_fault fault;
	size_t bytes = strlen(t.answer.text);
	assert_int_equal(cau_rpc_read(t.answer.text, bytes, bytes, &message, &fault), 0);
	assert_int_equal(cau_rpc_result(&message, method, result, NULL), CAU_OK);
	cau_rpc_finish(&message);
}

// The key that an answer gives.
static void take_key(char key[CAU_PROOF_BYTES], bool given, const char *text)
{
	assert_true(given);
	snprintf(key, CAU_PROOF_BYTES, "%s", text);
}

static bool serves(side *s, const char *id)
{
	cau_hosted *hosted = cau_hub_find(s->hub, id);
	cau_hosted_release(hosted);
	return hosted != NULL;
}

// ---- the courier's steps
static void begin_move(void)
{
	cau_wire_move_begun begun = {0};
	cau_move_asked asked = {.what = CAU_MOVE_BEGIN, .label = "d2", .to.session = "d2-knee"};
	assert_int_equal(make_session(&t.source, "knee"), CAU_OK);
	assert_int_equal(ask(&t.source, asked, CAU_METHOD_MOVE_BEGIN), CAU_OK);
	read_result(CAU_METHOD_MOVE_BEGIN, &begun);
	memcpy(t.move, begun.move, sizeof t.move);
}

// Carries the next piece. False: the source gives none now.
static bool carry_piece(cau_wire_move_received *received)
{
	if (ASK(source, READ))
		return false;
	unsigned char *piece = t.answer.file;
	size_t bytes = t.answer.file_bytes;
	t.answer.file = NULL;
	assert_int_equal(ASK(target, RECEIVE, .piece = piece, .piece_bytes = bytes), CAU_OK);
	*received = (cau_wire_move_received){0};
	read_result(CAU_METHOD_MOVE_RECEIVE, received);
	return true;
}

static void carry_part(void)
{
	int pieces = 0;
	cau_wire_move_received received = {0};
	while (pieces < PIECES_MOST && carry_piece(&received))
		pieces++;
	assert_int_equal(t.answer.status, CAU_BAD_STATE); // the rest, once it is suspended
	assert_in_range(pieces, 1, PIECES_MOST - 1);
	assert_false(received.has_receipt);
}

static void hold_and_carry_rest(char receipt[CAU_PROOF_BYTES])
{
	cau_wire_move_received received = {0};
	assert_int_equal(ASK(source, HOLD), CAU_OK);
	for (int pieces = 0; pieces < PIECES_MOST && !received.has_receipt; pieces++)
		assert_true(carry_piece(&received));
	take_key(receipt, received.has_receipt, received.receipt);
}

static void commit(const char *receipt, char proof[CAU_PROOF_BYTES])
{
	cau_wire_move_decision decision = {0};
	cau_move_asked asked = {.what = CAU_MOVE_COMMIT};
	snprintf(asked.key, sizeof asked.key, "%s", receipt);
	assert_int_equal(ask(&t.source, asked, CAU_METHOD_MOVE_COMMIT), CAU_OK);
	read_result(CAU_METHOD_MOVE_COMMIT, &decision);
	assert_true(decision.moved);
	take_key(proof, decision.has_proof, decision.proof);
}

static cau_status show(cau_move_what what, cau_method method, const char *key)
{
	cau_move_asked asked = {.what = what};
	snprintf(asked.key, sizeof asked.key, "%s", key);
	return ask(&t.target, asked, method);
}

// ---- the tests
static void a_session_moves_and_its_old_id_leads_to_it(void **state)
{
	(void)state;
	cau_moved_to to;
	char receipt[CAU_PROOF_BYTES], proof[CAU_PROOF_BYTES];
	begin_move();
	carry_part();
	assert_int_equal(ASK(target, READY), CAU_OK);
	assert_false(serves(&t.target, "d2-knee"));
	hold_and_carry_rest(receipt);
	assert_int_equal(show(CAU_MOVE_ACCEPT, CAU_METHOD_MOVE_ACCEPT, receipt), CAU_BAD_VALUE);
	commit(receipt, proof);
	assert_true(cau_hub_moved(t.source.hub, "d1-knee", &to));
	assert_string_equal(to.session, "d2-knee");
	assert_int_equal(make_session(&t.source, "knee"), CAU_ALREADY_EXISTS);
	assert_false(serves(&t.target, "d2-knee"));
	assert_int_equal(show(CAU_MOVE_ACCEPT, CAU_METHOD_MOVE_ACCEPT, proof), CAU_OK);
	assert_true(serves(&t.target, "d2-knee"));
	assert_false(cau_hub_moved(t.target.hub, "d2-knee", &to));
}

// The target builds it from its rows where no core was built beforehand.
static void it_moves_without_a_core_that_waits(void **state)
{
	(void)state;
	char receipt[CAU_PROOF_BYTES], proof[CAU_PROOF_BYTES];
	begin_move();
	carry_part();
	hold_and_carry_rest(receipt);
	commit(receipt, proof);
	assert_int_equal(show(CAU_MOVE_ACCEPT, CAU_METHOD_MOVE_ACCEPT, proof), CAU_OK);
	assert_true(serves(&t.target, "d2-knee"));
}

static void a_move_that_is_cancelled_leaves_the_session_and_frees_the_id(void **state)
{
	(void)state;
	cau_moved_to to;
	cau_wire_move_decision decision = {0};
	char receipt[CAU_PROOF_BYTES];
	begin_move();
	carry_part();
	assert_int_equal(ASK(target, READY), CAU_OK);
	hold_and_carry_rest(receipt);
	assert_int_equal(make_session(&t.target, "knee"), CAU_ALREADY_EXISTS);
	assert_int_equal(show(CAU_MOVE_FORGET, CAU_METHOD_MOVE_FORGET, receipt), CAU_BAD_VALUE);
	assert_int_equal(ASK(source, CANCEL), CAU_OK);
	read_result(CAU_METHOD_MOVE_CANCEL, &decision);
	assert_false(decision.moved);
	assert_true(decision.has_release);
	assert_true(serves(&t.source, "d1-knee"));
	assert_false(cau_hub_moved(t.source.hub, "d1-knee", &to));
	assert_int_equal(show(CAU_MOVE_FORGET, CAU_METHOD_MOVE_FORGET, decision.release), CAU_OK);
	cau_moves_reap(t.target.moves);
	assert_int_equal(make_session(&t.target, "knee"), CAU_OK);
}

// As the daemon ends: the suspended session goes on and is drained; no courier begins another move.
static void as_the_daemon_ends_no_move_goes_on(void **state)
{
	(void)state;
	char receipt[CAU_PROOF_BYTES];
	begin_move();
	carry_part();
	hold_and_carry_rest(receipt);
	cau_moves_drain(t.source.moves);
	assert_true(serves(&t.source, "d1-knee"));
	cau_move_asked asked = {.what = CAU_MOVE_COMMIT};
	snprintf(asked.key, sizeof asked.key, "%s", receipt);
	assert_int_equal(ask(&t.source, asked, CAU_METHOD_MOVE_COMMIT), CAU_BAD_STATE);
	assert_int_equal(t.answer.code, CAU_RPC_DRAINING);
}

// ---- proofs
static void a_seal_is_of_every_piece_in_its_order(void **state)
{
	(void)state;
	cau_move_hash a, ab, b, ba, receipt, of_another;
	assert_true(cau_move_seal("", "a", 1, a) && cau_move_seal(a, "b", 1, ab));
	assert_true(cau_move_seal("", "b", 1, b) && cau_move_seal(b, "a", 1, ba));
	assert_string_not_equal(ab, ba);
	assert_string_not_equal(ab, b);
	assert_true(cau_move_receipt("m1", ab, receipt) && cau_move_receipt("m2", ab, of_another));
	assert_string_not_equal(receipt, of_another);
}

static void a_release_is_of_one_secret_and_one_move(void **state)
{
	(void)state;
	cau_move_hash release, again, of_another, lock;
	assert_true(cau_move_release("secret", "m1", release));
	assert_true(cau_move_release("secret", "m1", again));
	assert_string_equal(release, again);
	assert_true(cau_move_release("secret", "m2", of_another));
	assert_string_not_equal(release, of_another);
	assert_true(cau_sha256(release, strlen(release), lock));
	assert_true(cau_move_opens(release, lock));
	assert_false(cau_move_opens(of_another, lock));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_session_moves_and_its_old_id_leads_to_it),
		TEST(it_moves_without_a_core_that_waits),
		TEST(a_move_that_is_cancelled_leaves_the_session_and_frees_the_id),
		TEST(as_the_daemon_ends_no_move_goes_on),
		cmocka_unit_test(a_seal_is_of_every_piece_in_its_order),
		cmocka_unit_test(a_release_is_of_one_secret_and_one_move),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests requests that arrive between the decision and the end of an earlier request. The earlier
// request is stopped at a fault point meanwhile.
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "move/internal.h"
#include "server/move/two_daemons.h"
#include "store/rows.h"

// Carries a move up to its decision, with a core that waits at the target.
static void decide(char proof[CAU_PROOF_BYTES])
{
	char receipt[CAU_PROOF_BYTES];
	begin_move();
	carry_part();
	assert_int_equal(ASK(target, READY), CAU_OK);
	hold_and_carry_rest(receipt);
	commit(receipt, proof);
}

// Asks the target to accept. Returns once the request is stopped at the fault point.
static void accept_up_to(const char *fault_point, const char *proof)
{
	cau_move_asked asked = {.what = CAU_MOVE_ACCEPT};
	snprintf(asked.key, sizeof asked.key, "%s", proof);
	set_gate(fault_point);
	send_request(&t.target, asked, CAU_METHOD_MOVE_ACCEPT, &t.held);
	await_gate();
}

static cau_move_asked seal_piece(cau_rows_writer *writer, const char *before)
{
	cau_move_hash seal;
	assert_true(cau_move_seal(before, writer->bytes, writer->byte_count, seal));
	cau_rows_append(writer, seal, CAU_SEAL_BYTES);
	assert_false(writer->failed);
	return (cau_move_asked){
		.what = CAU_MOVE_RECEIVE, .piece = writer->bytes, .piece_bytes = writer->byte_count};
}

static void put_session(cau_rows_writer *writer)
{
	cau_row row = {.table = CAU_ROWS_SESSION,
	               .column_count = 3,
	               .column = {{CAU_COLUMN_TEXT, .bytes = "paused", .byte_count = 6},
	                          {CAU_COLUMN_INTEGER, .integer = 1},
	                          {CAU_COLUMN_BLOB, .bytes = "{}", .byte_count = 2}}};
	cau_rows_put(writer, &row);
}

// Sends the target the first piece of another move, for a session with the same id.
static cau_status give_first_piece_of_another(bool with_session)
{
	static const char lock[] = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
	char kept[CAU_NAME_BYTES];
	cau_rows_writer writer = {0};
	cau_rows_begin(&writer, 0);
	cau_rows_put_values(&writer, CAU_ROWS_HEADER, "m2", lock, "d3-knee", "d3", "sheet", lock);
	if (with_session)
		put_session(&writer);
	cau_move_asked asked = seal_piece(&writer, "");
	memcpy(kept, t.move, sizeof kept);
	snprintf(t.move, sizeof t.move, "m2");
	cau_status status = ask(&t.target, asked, CAU_METHOD_MOVE_RECEIVE);
	memcpy(t.move, kept, sizeof t.move);
	return status;
}

// ---- pieces
static void a_first_piece_without_a_session_is_refused(void **state)
{
	(void)state;
	assert_int_equal(give_first_piece_of_another(false), CAU_BAD_VALUE);
	assert_int_equal(give_first_piece_of_another(true), CAU_OK);
}

// ---- requests during an acceptance
static void a_new_move_does_not_end_an_arrival_that_is_being_placed(void **state)
{
	(void)state;
	char proof[CAU_PROOF_BYTES];
	decide(proof);
	accept_up_to("move_placing", proof);
	assert_int_equal(give_first_piece_of_another(true), CAU_BAD_STATE);
	assert_non_null(strstr(t.answer.reason, "try again"));
	set_gate(NULL);
	assert_int_equal(await(&t.held), CAU_OK);
	assert_true(serves(&t.target, "d2-knee"));
	await_mover(&t.target, 0);
	assert_int_equal(give_first_piece_of_another(true), CAU_ALREADY_EXISTS);
	assert_int_equal(show(CAU_MOVE_ACCEPT, CAU_METHOD_MOVE_ACCEPT, proof), CAU_OK);
}

static void a_repeated_accept_waits_for_the_first(const char *fault_point, int held)
{
	char proof[CAU_PROOF_BYTES];
	decide(proof);
	accept_up_to(fault_point, proof);
	cau_move_asked again = {.what = CAU_MOVE_ACCEPT};
	snprintf(again.key, sizeof again.key, "%s", proof);
	send_request(&t.target, again, CAU_METHOD_MOVE_ACCEPT, &t.answer);
	await_mover(&t.target, held);
	bool early = is_answered(&t.answer);
	set_gate(NULL);
	assert_int_equal(await(&t.held), CAU_OK);
	assert_int_equal(await(&t.answer), CAU_OK);
	assert_false(early);
	assert_non_null(strstr(t.answer.text, "d2-knee"));
}

static void a_repeated_accept_waits_while_the_session_is_placed(void **state)
{
	(void)state;
	a_repeated_accept_waits_for_the_first("move_placing", 1);
}

static void a_repeated_accept_waits_for_the_disk(void **state)
{
	(void)state;
	a_repeated_accept_waits_for_the_first("move_accepted", 0);
}

// The session is in the store, but not among the hub's yet, as if it could not be resumed.
static void a_session_that_is_being_placed_is_not_destroyed(void **state)
{
	(void)state;
	char proof[CAU_PROOF_BYTES];
	cau_asker admin = {.name = "admin", .role = CAU_ROLE_ADMIN};
	decide(proof);
	accept_up_to("move_placing", proof);
	cau_reply reply = reply_to(&t.answer, CAU_METHOD_SESSION_DESTROY);
	assert_true(cau_hub_submit_missing(t.target.hub, "d2-knee", &admin, 0, &reply));
	assert_int_equal(await(&t.answer), CAU_BAD_STATE);
	set_gate(NULL);
	assert_int_equal(await(&t.held), CAU_OK);
	assert_true(serves(&t.target, "d2-knee"));
}

// Called when the hub asks whether the session is arriving. The acceptance ends at this moment.
static bool arrives_no_longer(void *user, const char *id)
{
	set_gate(NULL);
	await_mover(&t.target, 0);
	return cau_arrivals_have(user, id);
}

static void place_when_asked(void)
{
	char proof[CAU_PROOF_BYTES];
	decide(proof);
	accept_up_to("move_placing", proof);
	cau_elsewhere elsewhere = {.user = t.target.moves, .arrives = arrives_no_longer};
	cau_hub_set_elsewhere(t.target.hub, &elsewhere);
}

static void a_session_that_was_placed_just_now_is_not_destroyed_as_unserved(void **state)
{
	(void)state;
	cau_asker admin = {.name = "admin", .role = CAU_ROLE_ADMIN};
	place_when_asked();
	cau_reply reply = reply_to(&t.answer, CAU_METHOD_SESSION_DESTROY);
	assert_true(cau_hub_submit_missing(t.target.hub, "d2-knee", &admin, 0, &reply));
	assert_int_equal(await(&t.answer), CAU_NOT_FOUND);
	assert_int_equal(await(&t.held), CAU_OK);
	assert_true(serves(&t.target, "d2-knee"));
}

static void a_session_that_was_placed_just_now_is_not_made_again(void **state)
{
	(void)state;
	place_when_asked();
	assert_int_equal(make_session(&t.target, "knee"), CAU_ALREADY_EXISTS);
	assert_string_equal(t.answer.reason, "`d2-knee` exists");
	assert_int_equal(await(&t.held), CAU_OK);
}

static void a_piece_after_the_last_is_refused_while_it_is_accepted(void **state)
{
	(void)state;
	char proof[CAU_PROOF_BYTES];
	cau_rows_writer writer = {0};
	decide(proof);
	accept_up_to("move_accepted", proof);
	cau_rows_begin(&writer, t.pieces);
	send_request(&t.target, seal_piece(&writer, t.seal), CAU_METHOD_MOVE_RECEIVE, &t.answer);
	await_mover(&t.target, 0);
	set_gate(NULL);
	assert_int_equal(await(&t.answer), CAU_BAD_STATE);
	assert_int_equal(await(&t.held), CAU_OK);
}

static void destroy_session(side *s, const char *id)
{
	cau_hosted *hosted = cau_hub_find(s->hub, id);
	cau_order *order = calloc(1, sizeof *order);
	assert_true(hosted && order);
	order->kind = CAU_ORDER_DESTROY;
	order->asker = (cau_asker){.name = "admin", .role = CAU_ROLE_ADMIN};
	order->reply = reply_to(&t.answer, CAU_METHOD_SESSION_DESTROY);
	assert_int_equal(cau_hosted_submit(hosted, order, NULL), CAU_OK);
	assert_int_equal(await(&t.answer), CAU_OK);
	while (!cau_hosted_ended(hosted))
		usleep(1000);
	cau_hosted_release(hosted);
}

// Creates two sessions. The first of them has ended and waits to be reaped.
static void fill_places(void)
{
	assert_int_equal(make_session(&t.target, "first"), CAU_OK);
	destroy_session(&t.target, "d2-first");
	assert_int_equal(make_session(&t.target, "second"), CAU_OK);
}

static void the_last_piece_may_be_sent_again_while_it_is_accepted(void **state)
{
	(void)state;
	char proof[CAU_PROOF_BYTES];
	cau_wire_move_received received = {0};
	decide(proof);
	accept_up_to("move_accepted", proof);
	cau_move_asked asked = {.what = CAU_MOVE_RECEIVE, .piece = t.last, .piece_bytes = t.last_bytes};
	t.last = NULL; // the request owns the bytes now
	assert_int_equal(ask(&t.target, asked, CAU_METHOD_MOVE_RECEIVE), CAU_OK);
	read_result(CAU_METHOD_MOVE_RECEIVE, &received);
	assert_true(received.has_receipt);
	set_gate(NULL);
	assert_int_equal(await(&t.held), CAU_OK);
}

// A core was built in advance, and there is no free slot among the hub's sessions.
static void a_core_without_a_place_is_cleared_away_before_a_new_move(void **state)
{
	(void)state;
	char receipt[CAU_PROOF_BYTES], proof[CAU_PROOF_BYTES];
	t.target.config.max_sessions = 1; // two slots, until ended sessions are reaped
	begin_move();
	carry_part();
	assert_int_equal(ASK(target, READY), CAU_OK);
	hold_and_carry_rest(receipt);
	commit(receipt, proof);
	fill_places();
	assert_int_equal(show(CAU_MOVE_ACCEPT, CAU_METHOD_MOVE_ACCEPT, proof), CAU_LIMIT);
	t.target.config.max_sessions = 4;
	await_mover(&t.target, 0);
	assert_int_equal(give_first_piece_of_another(true), CAU_BAD_STATE);
	assert_non_null(strstr(t.answer.reason, "try again"));
	cau_moves_reap(t.target.moves);
	// the session exists in the store
	assert_int_equal(give_first_piece_of_another(true), CAU_ALREADY_EXISTS);
	assert_int_equal(show(CAU_MOVE_ACCEPT, CAU_METHOD_MOVE_ACCEPT, proof), CAU_NOT_FOUND);
}

// ---- requests when the daemon ends
static void no_core_is_built_once_the_builder_may_have_ended(void **state)
{
	(void)state;
	begin_move();
	carry_part();
	set_gate("move_building");
	send_request(&t.target, (cau_move_asked){.what = CAU_MOVE_READY}, CAU_METHOD_MOVE_READY,
	             &t.held);
	await_gate();
	cau_moves_drain(t.target.moves);
	cau_builder_stop(t.target.builder);
	set_gate(NULL);
	assert_int_equal(await(&t.held), CAU_BAD_STATE);
	assert_int_equal(t.held.code, CAU_RPC_DRAINING);
}

static void no_piece_is_written_once_the_daemon_ends(void **state)
{
	(void)state;
	cau_rows_writer writer = {0};
	begin_move();
	carry_part();
	cau_rows_begin(&writer, t.pieces);
	set_gate("move_asked");
	send_request(&t.target, seal_piece(&writer, t.seal), CAU_METHOD_MOVE_RECEIVE, &t.held);
	await_gate();
	cau_moves_drain(t.target.moves);
	set_gate(NULL);
	assert_int_equal(await(&t.held), CAU_BAD_STATE);
	assert_int_equal(t.held.code, CAU_RPC_DRAINING);
}

static void nothing_is_forgotten_once_the_daemon_ends(void **state)
{
	(void)state;
	begin_move();
	carry_part();
	cau_move_asked asked = {.what = CAU_MOVE_FORGET, .source_lost = true};
	set_gate("move_asked");
	send_request(&t.target, asked, CAU_METHOD_MOVE_FORGET, &t.held);
	await_gate();
	cau_moves_drain(t.target.moves);
	set_gate(NULL);
	assert_int_equal(await(&t.held), CAU_BAD_STATE);
	assert_int_equal(t.held.code, CAU_RPC_DRAINING);
}

// ---- requests while a piece is read
static void a_move_is_not_decided_while_a_piece_is_read(void **state)
{
	(void)state;
	cau_move_asked asked = {.what = CAU_MOVE_COMMIT, .key = "of no move"};
	begin_move();
	carry_part();
	assert_int_equal(ASK(source, HOLD), CAU_OK);
	set_gate("move_reading");
	send_request(&t.source, (cau_move_asked){.what = CAU_MOVE_READ}, CAU_METHOD_MOVE_READ, &t.held);
	await_gate();
	assert_int_equal(ask(&t.source, asked, CAU_METHOD_MOVE_COMMIT), CAU_BAD_STATE);
	set_gate(NULL);
	assert_int_equal(await(&t.held), CAU_OK);
	assert_int_equal(ask(&t.source, asked, CAU_METHOD_MOVE_COMMIT), CAU_BAD_VALUE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_first_piece_without_a_session_is_refused),
		TEST(a_new_move_does_not_end_an_arrival_that_is_being_placed),
		TEST(a_repeated_accept_waits_while_the_session_is_placed),
		TEST(a_repeated_accept_waits_for_the_disk),
		TEST(a_session_that_is_being_placed_is_not_destroyed),
		TEST(a_session_that_was_placed_just_now_is_not_destroyed_as_unserved),
		TEST(a_session_that_was_placed_just_now_is_not_made_again),
		TEST(a_piece_after_the_last_is_refused_while_it_is_accepted),
		TEST(the_last_piece_may_be_sent_again_while_it_is_accepted),
		TEST(a_core_without_a_place_is_cleared_away_before_a_new_move),
		TEST(no_core_is_built_once_the_builder_may_have_ended),
		TEST(no_piece_is_written_once_the_daemon_ends),
		TEST(nothing_is_forgotten_once_the_daemon_ends),
		TEST(a_move_is_not_decided_while_a_piece_is_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

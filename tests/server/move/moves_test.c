// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a session that moves between two daemons. tests/e2e/move.test.mjs tests which process may
// be killed when.
#include <string.h>

#include "server/move/two_daemons.h"

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

// If no core was built in advance, the target builds it from the session's rows.
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

// When the daemon ends, the suspended session resumes and is drained. No courier can continue the
// move.
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

// ---- proofs and seals
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

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests what retention removes by age: left branches, answers, events, and the records of a deleted
// session.
#include "retention_fixture.h"

#include "store/store_state.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

static void a_left_branch_goes_after_its_time_and_no_sooner(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = retention_open(fixture);
	retention_log(store, 0, 0, 1000);
	retention_put_checkpoint(store, 0, 300);
	retention_put_checkpoint(store, 0, 400);
	retention_put_checkpoint(store, 0, 900);
	assert_int_equal(retention_open_branch(store, 1, 0, 400), CAU_OK);
	retention_log(store, 1, 400, 500);

	retention_clock_ms = RETENTION_START_MS + 24 * RETENTION_HOUR_MS - 1;
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 0);
	assert_int_equal(retention_count_log(store, 0), 1000);

	retention_clock_ms = RETENTION_START_MS + 24 * RETENTION_HOUR_MS;
	store = retention_retire(fixture, store, &removal);
	// the removed rows are the commands from tick 400 on, and the checkpoint at 900
	assert_int_equal(removal.rows, 600 + 1);
	assert_true(removal.most <= 256);
	assert_int_equal(retention_count_log(store, 0), 400);
	// the log is complete, because the shared past stayed
	assert_int_equal(retention_count_log(store, 1), 500);
	assert_int_equal(retention_newest_checkpoint(store, 1, 450), 400);
	assert_int_equal(retention_newest_checkpoint(store, 0, 1000), 400);
	assert_int_equal(retention_count_branches(store), 2);
	// A removed part cannot be forked from; a part that is left can.
	assert_int_equal(retention_open_branch(store, 2, 0, 401), CAU_NOT_FOUND);
	assert_int_equal(retention_open_branch(store, 2, 0, 400), CAU_OK);
	cau_store_close(store);
}

static void a_branch_without_children_goes_altogether(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = retention_open(fixture);
	retention_log(store, 0, 0, 100);
	assert_int_equal(retention_open_branch(store, 1, 0, 80), CAU_OK);
	retention_log(store, 1, 80, 120);
	// branch 2 is forked from branch 1
	assert_int_equal(retention_open_branch(store, 2, 1, 90), CAU_OK);
	retention_log(store, 2, 90, 95);
	assert_int_equal(retention_open_branch(store, 3, 0, 50), CAU_OK);
	retention_log(store, 3, 50, 60);
	retention_clock_ms = RETENTION_START_MS + 25 * RETENTION_HOUR_MS;
	store = retention_retire(fixture, store, &removal);
	// Branch 2 and then branch 1 lose their children and are removed. Of branch 0, the past of
	// branch 3 stays.
	assert_int_equal(retention_count_branches(store), 2);
	assert_int_equal(retention_count_log(store, 0), 50);
	assert_int_equal(retention_count_log(store, 3), 60);
	assert_int_equal(removal.rows, 50 + 40 + 5 + 2);
	cau_store_close(store);
}

static cau_status ignore_answer(void *user, const cau_store_answer *answer)
{
	(void)user, (void)answer;
	return CAU_OK;
}

static void old_answers_and_events_go(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = retention_open(fixture);
	for (uint64_t i = 0; i < 2; i++) {
		cau_store_batch *batch = cau_store_batch_create();
		cau_store_answer answer = {.client = "c", .sequence = i};
		cau_store_event event = {.session = "knee", .tick = i, .kind = "k", .text = "t"};
		assert_int_equal(cau_store_put_answer(batch, &answer, NULL), CAU_OK);
		assert_int_equal(cau_store_put_event(batch, &event, NULL), CAU_OK);
		assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
		retention_clock_ms += 20 * RETENTION_HOUR_MS;
	}
	store =
		// the clock is 40 h after the first answer, 20 h after the second
		retention_retire(fixture, store, &removal);
	assert_int_equal(cau_store_read_answer(store, "c", 0, ignore_answer, NULL, NULL),
	                 CAU_ALREADY_EXISTS); // the answer is forgotten: a resend must not act again
	assert_int_equal(cau_store_read_answer(store, "c", 1, ignore_answer, NULL, NULL), CAU_OK);
	assert_int_equal(cau_store_read_answer(store, "c", 2, ignore_answer, NULL, NULL),
	                 CAU_NOT_FOUND);
	assert_int_equal(cau_store_read_answer(store, "d", 0, ignore_answer, NULL, NULL),
	                 CAU_NOT_FOUND);
	int events = 0;
	assert_int_equal(
		cau_store_read_events(store, "knee", NULL, 10, retention_count_event, &events, NULL),
		CAU_OK);
	assert_int_equal(events, 2);
	retention_clock_ms = RETENTION_START_MS + 30 * 24 * RETENTION_HOUR_MS + 1;
	store = retention_retire(fixture, store, &removal);
	events = 0;
	assert_int_equal(
		cau_store_read_events(store, "knee", NULL, 10, retention_count_event, &events, NULL),
		CAU_OK);
	assert_int_equal(events, 1);
	assert_int_equal(cau_store_read_answer(store, "c", 1, ignore_answer, NULL, NULL),
	                 CAU_ALREADY_EXISTS);
	// after a longer time even the note is removed
	retention_clock_ms += 60 * 24 * RETENTION_HOUR_MS;
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(cau_store_read_answer(store, "c", 1, ignore_answer, NULL, NULL),
	                 CAU_NOT_FOUND);
	cau_store_close(store);
}

// The store thread takes the same steps between commits. Each small commit gives it a turn.
static void the_thread_removes_a_deleted_session(void **state)
{
	struct fixture *fixture = *state;
	// longest wait for the removal, s, which takes some milliseconds
	static const double patience_s = 20.0;
	cau_store_metrics metrics;
	cau_store_close(retention_open(fixture));
	fixture->config.retention_interval_ms = 1;
	fixture->config.commit_delay_ms = 0;
	cau_store *store = open_store(&fixture->config);
	retention_log(store, 0, 0, 700);
	retention_put_checkpoint(store, 0, 10);
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_store_delete_session(batch, "knee", NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	double end_s = cau_store_monotonic_s() + patience_s;
	do {
		batch = cau_store_batch_create();
		cau_store_event event = {.kind = "turn", .text = ""};
		assert_int_equal(cau_store_put_event(batch, &event, NULL), CAU_OK);
		assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
		cau_store_get_metrics(store, &metrics);
		assert_true(cau_store_monotonic_s() < end_s);
		// rows of the log, of the checkpoint, the branch and the session
	} while (metrics.retired_rows < 700 + 1 + 1 + 1);
	cau_store_close(store);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_left_branch_goes_after_its_time_and_no_sooner),
		TEST(a_branch_without_children_goes_altogether),
		TEST(old_answers_and_events_go),
		TEST(the_thread_removes_a_deleted_session),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

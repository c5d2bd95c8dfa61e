// SPDX-License-Identifier: GPL-3.0-or-later
// What may go goes, in small steps; what is needed to replay the kept lines stays. The clock is the
// test's.
#include "store_fixture.h"

#include <sqlite3.h>
#include <stdatomic.h>
#include <string.h>

#include "store/clock.h"
#include "store/file.h"
#include "store/retention.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

static const int64_t hour_ms = 3600000;
static const int64_t start_ms = 1700000000000;
static _Atomic int64_t clock_ms;

static int64_t test_clock_ms(void)
{
	return clock_ms;
}

static cau_store *open_with_knee(struct fixture *fixture)
{
	clock_ms = start_ms;
	fixture->config.wall_clock_ms = test_clock_ms;
	fixture->config.retention_interval_ms = INT32_MAX; // the test takes the steps itself
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	return store;
}

static void log_ticks(cau_store *store, int64_t branch, uint64_t from, uint64_t before)
{
	cau_store_batch *batch = cau_store_batch_create();
	for (uint64_t tick = from; tick < before; tick++)
		put_tick_command(batch, "knee", branch, tick);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static void put_checkpoint(cau_store *store, int64_t branch, uint64_t tick)
{
	static const char snapshot[100000];
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_checkpoint checkpoint = {
		.session = "knee", .branch = branch, .tick = tick, .snapshot = {snapshot, sizeof snapshot}};
	assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static cau_status open_branch(cau_store *store, int64_t branch, int64_t parent, uint64_t fork_tick)
{
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_branch opened = {
		.session = "knee", .branch = branch, .parent = parent, .fork_tick = fork_tick};
	assert_int_equal(cau_store_put_branch(batch, &opened, NULL), CAU_OK);
	return write_batch(store, batch, NULL);
}

struct removal {
	int64_t rows, steps, most;
};

// Closes the store, takes retention's steps until nothing may go, and opens it again.
static cau_store *retire(struct fixture *fixture, cau_store *store, struct removal *removal)
{
	sqlite3 *database;
	int64_t rows;
	*removal = (struct removal){0};
	cau_store_close(store);
	assert_int_equal(cau_store_file_open(fixture->path, 1 << 20, &database, NULL), CAU_OK);
	do {
		cau_error error = {0};
		if (cau_store_retention_step(database, &fixture->config, &rows, &error))
			fail_msg("%s", error.reason);
		removal->rows += rows;
		removal->steps += rows > 0;
		if (rows > removal->most)
			removal->most = rows;
	} while (rows);
	sqlite3_close(database);
	return open_store(&fixture->config);
}

static int count_log(cau_store *store, int64_t branch)
{
	static uint64_t ticks[5000];
	int count = read_ticks(store, "knee", branch, 0, 100000, ticks, 5000);
	for (int i = 0; i < count; i++)
		assert_int_equal(ticks[i], i); // whole from the start
	return count;
}

static cau_status see_tick(void *user, const cau_store_checkpoint *checkpoint)
{
	*(int64_t *)user = (int64_t)checkpoint->tick;
	return CAU_OK;
}

static int64_t newest_checkpoint(cau_store *store, int64_t branch, uint64_t tick)
{
	int64_t found = -1;
	cau_store_read_checkpoint(store, "knee", branch, tick, see_tick, &found, NULL);
	return found;
}

static cau_status count_branch(void *user, const cau_store_branch *branch)
{
	(void)branch;
	++*(int *)user;
	return CAU_OK;
}

static int count_branches(cau_store *store)
{
	int count = 0;
	assert_int_equal(cau_store_read_branches(store, "knee", count_branch, &count, NULL), CAU_OK);
	return count;
}

static void a_left_branch_goes_after_its_time_and_no_sooner(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = open_with_knee(fixture);
	log_ticks(store, 0, 0, 1000);
	put_checkpoint(store, 0, 300);
	put_checkpoint(store, 0, 400);
	put_checkpoint(store, 0, 900);
	assert_int_equal(open_branch(store, 1, 0, 400), CAU_OK);
	log_ticks(store, 1, 400, 500);

	clock_ms = start_ms + 24 * hour_ms - 1;
	store = retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 0);
	assert_int_equal(count_log(store, 0), 1000);

	clock_ms = start_ms + 24 * hour_ms;
	store = retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 600 + 1); // commands from 400 on, the checkpoint at 900
	assert_true(removal.most <= 256);
	assert_int_equal(count_log(store, 0), 400);
	assert_int_equal(count_log(store, 1), 500); // whole: the shared past stayed
	assert_int_equal(newest_checkpoint(store, 1, 450), 400);
	assert_int_equal(newest_checkpoint(store, 0, 1000), 400);
	assert_int_equal(count_branches(store), 2);
	// What has gone cannot be forked from; what is left can.
	assert_int_equal(open_branch(store, 2, 0, 401), CAU_NOT_FOUND);
	assert_int_equal(open_branch(store, 2, 0, 400), CAU_OK);
	cau_store_close(store);
}

static void a_branch_without_children_goes_altogether(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = open_with_knee(fixture);
	log_ticks(store, 0, 0, 100);
	assert_int_equal(open_branch(store, 1, 0, 80), CAU_OK);
	log_ticks(store, 1, 80, 120);
	assert_int_equal(open_branch(store, 2, 1, 90), CAU_OK); // 1 is its parent
	log_ticks(store, 2, 90, 95);
	assert_int_equal(open_branch(store, 3, 0, 50), CAU_OK);
	log_ticks(store, 3, 50, 60);
	clock_ms = start_ms + 25 * hour_ms;
	store = retire(fixture, store, &removal);
	// 2, then 1 have no children left; of 0 the past of 3 is kept.
	assert_int_equal(count_branches(store), 2);
	assert_int_equal(count_log(store, 0), 50);
	assert_int_equal(count_log(store, 3), 60);
	assert_int_equal(removal.rows, 50 + 40 + 5 + 2);
	cau_store_close(store);
}

static void a_big_session_loses_left_branches_then_old_checkpoints(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	fixture->config.retention_bytes = 450000; // four of the test's checkpoints
	cau_store *store = open_with_knee(fixture);
	log_ticks(store, 0, 0, 100);
	for (uint64_t tick = 10; tick <= 60; tick += 10)
		put_checkpoint(store, 0, tick);
	assert_int_equal(open_branch(store, 1, 0, 30), CAU_OK);
	store = retire(fixture, store, &removal);
	// Two of the left branch's own checkpoints (40 to 60) make room enough.
	assert_int_equal(removal.rows, 2);
	assert_int_equal(newest_checkpoint(store, 0, 100), 40);
	assert_int_equal(newest_checkpoint(store, 1, 100), 30);
	assert_int_equal(newest_checkpoint(store, 1, 19), 10);
	assert_int_equal(count_log(store, 0), 100);
	assert_int_equal(count_log(store, 1), 30);

	log_ticks(store, 1, 30, 200);
	for (uint64_t tick = 40; tick <= 100; tick += 10)
		put_checkpoint(store, 1, tick);
	store = retire(fixture, store, &removal);
	assert_int_equal(newest_checkpoint(store, 1, 1000), 100);
	assert_int_equal(newest_checkpoint(store, 1, 60), -1); // the oldest went
	assert_int_equal(newest_checkpoint(store, 1, 75), 70);
	assert_int_equal(count_log(store, 0), 30);  // and all that was left behind
	assert_int_equal(count_log(store, 1), 200); // the log never
	cau_store_close(store);
}

static void the_newest_two_checkpoints_stay_whatever_the_limit(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	fixture->config.retention_bytes = 0;
	cau_store *store = open_with_knee(fixture);
	for (uint64_t tick = 10; tick <= 50; tick += 10)
		put_checkpoint(store, 0, tick);
	store = retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 3);
	assert_int_equal(newest_checkpoint(store, 0, 45), 40);
	assert_int_equal(newest_checkpoint(store, 0, 39), -1);
	cau_store_close(store);
}

static cau_status ignore_answer(void *user, const cau_store_answer *answer)
{
	(void)user, (void)answer;
	return CAU_OK;
}

static cau_status count_event(void *user, const cau_store_event *event)
{
	(void)event;
	++*(int *)user;
	return CAU_OK;
}

static void old_answers_and_events_go(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = open_with_knee(fixture);
	for (uint64_t i = 0; i < 2; i++) {
		cau_store_batch *batch = cau_store_batch_create();
		cau_store_answer answer = {.client = "c", .sequence = i};
		cau_store_event event = {.session = "knee", .tick = i, .kind = "k", .text = "t"};
		assert_int_equal(cau_store_put_answer(batch, &answer, NULL), CAU_OK);
		assert_int_equal(cau_store_put_event(batch, &event, NULL), CAU_OK);
		assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
		clock_ms += 20 * hour_ms;
	}
	store = retire(fixture, store, &removal); // 40 h after the first, 20 h after the second
	assert_int_equal(cau_store_read_answer(store, "c", 0, ignore_answer, NULL, NULL),
	                 CAU_ALREADY_EXISTS); // it must not act again
	assert_int_equal(cau_store_read_answer(store, "c", 1, ignore_answer, NULL, NULL), CAU_OK);
	assert_int_equal(cau_store_read_answer(store, "c", 2, ignore_answer, NULL, NULL),
	                 CAU_NOT_FOUND);
	assert_int_equal(cau_store_read_answer(store, "d", 0, ignore_answer, NULL, NULL),
	                 CAU_NOT_FOUND);
	int events = 0;
	assert_int_equal(cau_store_read_events(store, "knee", NULL, 10, count_event, &events, NULL),
	                 CAU_OK);
	assert_int_equal(events, 2);
	clock_ms = start_ms + 30 * 24 * hour_ms + 1;
	store = retire(fixture, store, &removal);
	events = 0;
	assert_int_equal(cau_store_read_events(store, "knee", NULL, 10, count_event, &events, NULL),
	                 CAU_OK);
	assert_int_equal(events, 1);
	assert_int_equal(cau_store_read_answer(store, "c", 1, ignore_answer, NULL, NULL),
	                 CAU_ALREADY_EXISTS);
	clock_ms += 60 * 24 * hour_ms; // in the end that is forgotten too
	store = retire(fixture, store, &removal);
	assert_int_equal(cau_store_read_answer(store, "c", 1, ignore_answer, NULL, NULL),
	                 CAU_NOT_FOUND);
	cau_store_close(store);
}

// The store's own thread does the same beside commits. Each small commit gives it a turn.
static void the_thread_removes_a_deleted_session(void **state)
{
	struct fixture *fixture = *state;
	static const double patience_s = 20.0; // it takes some milliseconds
	cau_store_metrics metrics;
	cau_store_close(open_with_knee(fixture));
	fixture->config.retention_interval_ms = 1;
	fixture->config.commit_delay_ms = 0;
	cau_store *store = open_store(&fixture->config);
	log_ticks(store, 0, 0, 700);
	put_checkpoint(store, 0, 10);
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
	} while (metrics.retired_rows < 700 + 1 + 1 + 1); // log, checkpoint, branch, session
	cau_store_close(store);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_left_branch_goes_after_its_time_and_no_sooner),
		TEST(a_branch_without_children_goes_altogether),
		TEST(a_big_session_loses_left_branches_then_old_checkpoints),
		TEST(the_newest_two_checkpoints_stay_whatever_the_limit),
		TEST(old_answers_and_events_go),
		TEST(the_thread_removes_a_deleted_session),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What may go goes, in small steps; what is needed to replay the kept lines stays. The clock is the
// test's.
#include "store_fixture.h"

#include <sqlite3.h>
#include <stdatomic.h>
#include <string.h>

#include "store/clock.h"
#include "store/fault.h"
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

// ---- the present line -----------------------------------------------------------------
static bool is_reached(cau_store *store, int64_t branch, uint64_t tick)
{
	return cau_store_check_reach(store, "knee", branch, tick, NULL) == CAU_OK;
}

// What can be reached, told by what is there: with a command at every tick, a state is reached if
// the commands from the newest checkpoint on are all there.
static bool can_be_replayed(cau_store *store, int64_t branch, uint64_t tick)
{
	static uint64_t ticks[20000];
	int64_t from = newest_checkpoint(store, branch, tick);
	return from >= 0 && read_ticks(store, "knee", branch, (uint64_t)from, tick, ticks, 20000) ==
	                        (int)tick - (int)from;
}

// Every tick up to `end` that is said to be reached can be replayed, and the other way round; from
// the oldest tick on all are.
static void check_what_is_said(cau_store *store, int64_t branch, uint64_t end, uint64_t stride)
{
	uint64_t oldest;
	assert_int_equal(cau_store_read_oldest_tick(store, "knee", branch, &oldest, NULL), CAU_OK);
	for (uint64_t tick = 0; tick <= end; tick += stride) {
		if (is_reached(store, branch, tick) != can_be_replayed(store, branch, tick))
			fail_msg("tick %d of branch %d", (int)tick, (int)branch);
		assert_true(tick < oldest || is_reached(store, branch, tick));
	}
	assert_true(oldest == 0 || !is_reached(store, branch, oldest - 1));
}

static void a_big_session_loses_left_branches_first(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	fixture->config.retention_bytes = 900000; // eight checkpoints of the test's, and some log
	cau_store *store = open_with_knee(fixture);
	log_ticks(store, 0, 0, 60);
	for (uint64_t tick = 0; tick < 6; tick++)
		put_checkpoint(store, 0, 1000 * tick);
	assert_int_equal(open_branch(store, 1, 0, 3000), CAU_OK);
	for (uint64_t tick = 3; tick < 7; tick++)
		put_checkpoint(store, 1, 1000 * tick);
	store = retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 2); // 5000 and 4000 of the left branch made room enough
	assert_int_equal(newest_checkpoint(store, 0, 10000), 3000);
	assert_int_equal(newest_checkpoint(store, 1, 2999), 2000);
	assert_int_equal(newest_checkpoint(store, 1, 10000), 6000);
	assert_int_equal(count_log(store, 0), 60);
	cau_store_close(store);
}

static void the_first_checkpoint_and_the_newest_two_stay_whatever_the_limit(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	fixture->config.retention_bytes = 0;
	cau_store *store = open_with_knee(fixture);
	for (uint64_t tick = 10; tick <= 50; tick += 10)
		put_checkpoint(store, 0, tick);
	store = retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 2);
	assert_int_equal(newest_checkpoint(store, 0, 100), 50);
	assert_int_equal(newest_checkpoint(store, 0, 49), 40);
	assert_int_equal(newest_checkpoint(store, 0, 39), 10);
	cau_store_close(store);
}

// Forty times back and on again, each time from where the last came to. Reset means tick 0.
static void whatever_was_rewound_tick_0_can_be_reached(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	fixture->config.retention_bytes = 500000;
	cau_store *store = open_with_knee(fixture);
	uint64_t tick = 0;
	put_checkpoint(store, 0, 0);
	for (int64_t branch = 0; branch < 40; branch++) {
		log_ticks(store, branch, tick, tick + 100);
		put_checkpoint(store, branch, tick + 50);
		tick += 80;
		assert_int_equal(open_branch(store, branch + 1, branch, tick), CAU_OK);
		put_checkpoint(store, branch + 1, tick);
		if (branch % 8 == 7) {
			store = retire(fixture, store, &removal);
			check_what_is_said(store, branch + 1, tick, 7);
		}
		assert_true(is_reached(store, branch + 1, 0));
		assert_true(is_reached(store, branch + 1, tick));
	}
	assert_int_equal(open_branch(store, 41, 40, 0), CAU_OK);
	put_checkpoint(store, 41, 0);
	clock_ms = start_ms + 25 * hour_ms;
	store = retire(fixture, store, &removal);
	assert_int_equal(newest_checkpoint(store, 0, 0), 0);
	assert_int_equal(count_branches(store), 2); // what came of the rest is gone
	check_what_is_said(store, 41, 0, 1);
	cau_store_close(store);
}

static void put_mark(cau_store *store, int64_t branch, uint64_t tick)
{
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_event event = {
		.session = "knee", .branch = branch, .tick = tick, .kind = "snapshot", .text = "named"};
	assert_int_equal(cau_store_put_event(batch, &event, NULL), CAU_OK);
	assert_int_equal(cau_store_put_mark(batch, "knee", branch, tick, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static cau_status count_event(void *user, const cau_store_event *event)
{
	(void)event;
	++*(int *)user;
	return CAU_OK;
}

// One with a checkpoint of its own, one that the log leads to, on a branch that was left long ago.
static void marked_states_and_their_events_stay(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	int events = 0;
	fixture->config.retention_bytes = 0;
	cau_store *store = open_with_knee(fixture);
	for (uint64_t tick = 0; tick < 1000; tick += 100) {
		log_ticks(store, 0, tick, tick + 100);
		put_checkpoint(store, 0, tick);
	}
	put_mark(store, 0, 300);
	put_mark(store, 0, 650);
	assert_int_equal(open_branch(store, 1, 0, 200), CAU_OK);
	log_ticks(store, 1, 200, 900);
	for (uint64_t tick = 200; tick < 900; tick += 100)
		put_checkpoint(store, 1, tick);
	clock_ms = start_ms + 100 * 24 * hour_ms;
	store = retire(fixture, store, &removal);
	assert_int_equal(newest_checkpoint(store, 0, 300), 300);
	assert_true(can_be_replayed(store, 0, 300));
	assert_true(can_be_replayed(store, 0, 650));
	check_what_is_said(store, 0, 650, 5);
	check_what_is_said(store, 1, 900, 5);
	assert_int_equal(cau_store_read_events(store, "knee", NULL, 10, count_event, &events, NULL),
	                 CAU_OK);
	assert_int_equal(events, 2);
	cau_store_close(store);
}

// The log is more than the limit. What goes is told after every step, each of which is a
// transaction: a crash between two leaves nothing untrue.
static void a_log_beyond_the_limit_goes_as_a_gap_that_is_told(void **state)
{
	struct fixture *fixture = *state;
	const uint64_t end = 12000;
	cau_error error = {0};
	sqlite3 *database;
	int64_t rows = 1;
	fixture->config.retention_bytes = 1000000;
	cau_store *store = open_with_knee(fixture);
	for (uint64_t tick = 0; tick < end; tick += 1000) {
		put_checkpoint(store, 0, tick);
		log_ticks(store, 0, tick, tick + 1000);
	}
	assert_int_equal(cau_store_file_open(fixture->path, 1 << 20, &database, NULL), CAU_OK);
	for (int step = 0; rows; step++) {
		assert_int_equal(cau_store_retention_step(database, &fixture->config, &rows, &error),
		                 CAU_OK);
		for (uint64_t tick = 0; step % 4 == 0 && tick <= end; tick += 333)
			assert_true(!is_reached(store, 0, tick) || can_be_replayed(store, 0, tick));
	}
	sqlite3_close(database);
	check_what_is_said(store, 0, end, 37);

	uint64_t oldest;
	assert_int_equal(cau_store_read_oldest_tick(store, "knee", 0, &oldest, NULL), CAU_OK);
	assert_in_range(oldest, 1000, 11000);
	assert_int_equal(cau_store_check_reach(store, "knee", 0, 500, &error), CAU_BAD_VALUE);
	char reached[64];
	snprintf(reached, sizeof reached, "can be reached: 0, %d on", (int)oldest);
	assert_non_null(strstr(error.reason, reached));
	assert_string_equal(error.path, "params.tick");
	cau_store_close(store);
}

static void what_could_not_be_stored_is_a_gap(void **state)
{
	cau_error error = {0};
	cau_store *store = open_with_knee(*state);
	put_checkpoint(store, 0, 0);
	log_ticks(store, 0, 0, 100);
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_gap gap = {.session = "knee", .from_tick = 100, .before_tick = 140};
	assert_int_equal(cau_store_put_gap(batch, &gap, NULL), CAU_OK);
	gap.before_tick = 100;
	assert_int_equal(cau_store_put_gap(batch, &gap, NULL), CAU_BAD_VALUE);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	put_checkpoint(store, 0, 140);
	log_ticks(store, 0, 140, 200);
	check_what_is_said(store, 0, 200, 1);
	assert_int_equal(cau_store_check_reach(store, "knee", 0, 120, &error), CAU_BAD_VALUE);
	assert_non_null(strstr(error.reason, "can be reached: 0 to 100, 140 on"));
	// The checkpoint that ends it stays, close as it stands.
	struct removal removal;
	put_checkpoint(store, 0, 100000);
	put_checkpoint(store, 0, 100001);
	store = retire(*state, store, &removal);
	assert_int_equal(removal.rows, 0);
	assert_int_equal(newest_checkpoint(store, 0, 200), 140);
	cau_store_close(store);
}

// Sixty hours that nobody touches: the daemon comes to one checkpoint in 256 checkpoint_s, here
// 153,600 ticks. README.md states the bounds.
static void an_untouched_weekend_is_small(void **state)
{
	static const uint64_t cadence = 153600, end = 60ull * 3600 * 60;
	struct fixture *fixture = *state;
	cau_error error = {0};
	int64_t rows, count, pages;
	sqlite3 *database;
	cau_store *store = open_with_knee(fixture);
	assert_int_equal(cau_store_file_open(fixture->path, 1 << 20, &database, NULL), CAU_OK);
	for (uint64_t tick = 0; tick <= end; tick += cadence) {
		put_checkpoint(store, 0, tick);
		do
			assert_int_equal(cau_store_retention_step(database, &fixture->config, &rows, &error),
			                 CAU_OK);
		while (rows);
		assert_true(is_reached(store, 0, tick / 2) && is_reached(store, 0, 0));
	}
	assert_int_equal(cau_store_integer(database, "SELECT count(*) FROM checkpoints", &count, NULL),
	                 CAU_OK);
	assert_int_equal(cau_store_integer(database, "PRAGMA page_count", &pages, NULL), CAU_OK);
	print_message("%d checkpoints of %d written, %d pages\n", (int)count, (int)(end / cadence) + 1,
	              (int)pages);
	assert_in_range(count, 3, 40);
	assert_in_range(pages * 4096, 1, 41 * 105000); // of 100 kB each: freed pages were used again
	sqlite3_close(database);
	cau_store_close(store);
}

// ---- answers and events ---------------------------------------------------------------
static cau_status ignore_answer(void *user, const cau_store_answer *answer)
{
	(void)user, (void)answer;
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
		TEST(a_big_session_loses_left_branches_first),
		TEST(the_first_checkpoint_and_the_newest_two_stay_whatever_the_limit),
		TEST(whatever_was_rewound_tick_0_can_be_reached),
		TEST(marked_states_and_their_events_stay),
		TEST(a_log_beyond_the_limit_goes_as_a_gap_that_is_told),
		TEST(what_could_not_be_stored_is_a_gap),
		TEST(an_untouched_weekend_is_small),
		TEST(old_answers_and_events_go),
		TEST(the_thread_removes_a_deleted_session),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

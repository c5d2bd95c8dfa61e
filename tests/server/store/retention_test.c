// SPDX-License-Identifier: GPL-3.0-or-later
// Tests retention of the present line of a big session: checkpoints are thinned and the oldest log
// is removed, in small steps. Everything that a replay of the rest needs stays, and so do marked
// states.
#include "retention_fixture.h"

#include <sqlite3.h>
#include <string.h>

#include "store/file.h"
#include "store/retention.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

static bool is_reached(cau_store *store, int64_t branch, uint64_t tick)
{
	return cau_store_check_reach(store, "knee", branch, tick, NULL) == CAU_OK;
}

// True if the stored records reach the tick. There is a command at every tick, so a state can be
// replayed if all commands from the newest checkpoint on are there.
static bool can_be_replayed(cau_store *store, int64_t branch, uint64_t tick)
{
	static uint64_t ticks[20000];
	int64_t from = retention_newest_checkpoint(store, branch, tick);
	return from >= 0 && read_ticks(store, "knee", branch, (uint64_t)from, tick, ticks, 20000) ==
	                        (int)tick - (int)from;
}

// Checks that a tick up to `end` is reported as reachable exactly if it can be replayed, and that
// all ticks from the oldest tick on can.
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
	// limit of a session's bytes: eight checkpoints of this test, and some log
	fixture->config.retention_bytes = 900000;
	cau_store *store = retention_open(fixture);
	retention_log(store, 0, 0, 60);
	for (uint64_t tick = 0; tick < 6; tick++)
		retention_put_checkpoint(store, 0, 1000 * tick);
	assert_int_equal(retention_open_branch(store, 1, 0, 3000), CAU_OK);
	for (uint64_t tick = 3; tick < 7; tick++)
		retention_put_checkpoint(store, 1, 1000 * tick);
	store = retention_retire(fixture, store, &removal);
	// removing the left branch's checkpoints at 5000 and 4000 was enough
	assert_int_equal(removal.rows, 2);
	assert_int_equal(retention_newest_checkpoint(store, 0, 10000), 3000);
	assert_int_equal(retention_newest_checkpoint(store, 1, 2999), 2000);
	assert_int_equal(retention_newest_checkpoint(store, 1, 10000), 6000);
	assert_int_equal(retention_count_log(store, 0), 60);
	cau_store_close(store);
}

static void the_first_checkpoint_and_the_newest_two_stay_whatever_the_limit(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	fixture->config.retention_bytes = 0;
	cau_store *store = retention_open(fixture);
	for (uint64_t tick = 10; tick <= 50; tick += 10)
		retention_put_checkpoint(store, 0, tick);
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 2);
	assert_int_equal(retention_newest_checkpoint(store, 0, 100), 50);
	assert_int_equal(retention_newest_checkpoint(store, 0, 49), 40);
	assert_int_equal(retention_newest_checkpoint(store, 0, 39), 10);
	cau_store_close(store);
}

// Rewinds and continues forty times, each time from where the last branch ended. A reset goes to
// tick 0.
static void whatever_was_rewound_tick_0_can_be_reached(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	fixture->config.retention_bytes = 500000;
	cau_store *store = retention_open(fixture);
	uint64_t tick = 0;
	retention_put_checkpoint(store, 0, 0);
	for (int64_t branch = 0; branch < 40; branch++) {
		retention_log(store, branch, tick, tick + 100);
		retention_put_checkpoint(store, branch, tick + 50);
		tick += 80;
		assert_int_equal(retention_open_branch(store, branch + 1, branch, tick), CAU_OK);
		retention_put_checkpoint(store, branch + 1, tick);
		if (branch % 8 == 7) {
			store = retention_retire(fixture, store, &removal);
			check_what_is_said(store, branch + 1, tick, 7);
		}
		assert_true(is_reached(store, branch + 1, 0));
		assert_true(is_reached(store, branch + 1, tick));
	}
	assert_int_equal(retention_open_branch(store, 41, 40, 0), CAU_OK);
	retention_put_checkpoint(store, 41, 0);
	retention_clock_ms = RETENTION_START_MS + 25 * RETENTION_HOUR_MS;
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(retention_newest_checkpoint(store, 0, 0), 0);
	assert_int_equal(retention_count_branches(store), 2); // the other branches are removed
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

// One marked state has a checkpoint of its own. Another marked state is reached by the log, on a
// branch that was left long ago.
static void marked_states_and_their_events_stay(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	int events = 0;
	fixture->config.retention_bytes = 0;
	cau_store *store = retention_open(fixture);
	for (uint64_t tick = 0; tick < 1000; tick += 100) {
		retention_log(store, 0, tick, tick + 100);
		retention_put_checkpoint(store, 0, tick);
	}
	put_mark(store, 0, 300);
	put_mark(store, 0, 650);
	assert_int_equal(retention_open_branch(store, 1, 0, 200), CAU_OK);
	retention_log(store, 1, 200, 900);
	for (uint64_t tick = 200; tick < 900; tick += 100)
		retention_put_checkpoint(store, 1, tick);
	retention_clock_ms = RETENTION_START_MS + 100 * 24 * RETENTION_HOUR_MS;
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(retention_newest_checkpoint(store, 0, 300), 300);
	assert_true(can_be_replayed(store, 0, 300));
	assert_true(can_be_replayed(store, 0, 650));
	check_what_is_said(store, 0, 650, 5);
	check_what_is_said(store, 1, 900, 5);
	assert_int_equal(
		cau_store_read_events(store, "knee", NULL, 10, retention_count_event, &events, NULL),
		CAU_OK);
	assert_int_equal(events, 2);
	cau_store_close(store);
}

// The log alone exceeds the limit. The removed range is reported after every step. Each step is a
// transaction, so a crash between two steps leaves no wrong report.
static void a_log_beyond_the_limit_goes_as_a_gap_that_is_told(void **state)
{
	struct fixture *fixture = *state;
	const uint64_t end = 12000;
	cau_error error = {0};
	sqlite3 *database;
	struct cau_store_budget budget = {0};
	int64_t rows = 1;
	fixture->config.retention_bytes = 1000000;
	cau_store *store = retention_open(fixture);
	for (uint64_t tick = 0; tick < end; tick += 1000) {
		retention_put_checkpoint(store, 0, tick);
		retention_log(store, 0, tick, tick + 1000);
	}
	assert_int_equal(cau_store_file_open(fixture->path, 1 << 20, &database, NULL), CAU_OK);
	for (int step = 0; rows; step++) {
		assert_int_equal(
			cau_store_retention_step(database, &fixture->config, &budget, &rows, &error), CAU_OK);
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
	cau_store *store = retention_open(*state);
	retention_put_checkpoint(store, 0, 0);
	retention_log(store, 0, 0, 100);
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_gap gap = {.session = "knee", .from_tick = 100, .before_tick = 140};
	assert_int_equal(cau_store_put_gap(batch, &gap, NULL), CAU_OK);
	gap.before_tick = 100;
	assert_int_equal(cau_store_put_gap(batch, &gap, NULL), CAU_BAD_VALUE);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	retention_put_checkpoint(store, 0, 140);
	retention_log(store, 0, 140, 200);
	check_what_is_said(store, 0, 200, 1);
	assert_int_equal(cau_store_check_reach(store, "knee", 0, 120, &error), CAU_BAD_VALUE);
	assert_non_null(strstr(error.reason, "can be reached: 0 to 100, 140 on"));
	// The checkpoint at the end of the gap stays, although it is close to others.
	struct removal removal;
	retention_put_checkpoint(store, 0, 100000);
	retention_put_checkpoint(store, 0, 100001);
	store = retention_retire(*state, store, &removal);
	assert_int_equal(removal.rows, 0);
	assert_int_equal(retention_newest_checkpoint(store, 0, 200), 140);
	cau_store_close(store);
}

// Sixty hours without commands, with one checkpoint every 153,600 ticks. server/README.md states
// the bounds on the number of checkpoints.
static void an_untouched_weekend_is_small(void **state)
{
	static const uint64_t cadence = 153600, end = 60ull * 3600 * 60;
	struct fixture *fixture = *state;
	cau_error error = {0};
	int64_t rows, count, pages;
	struct cau_store_budget budget = {0};
	sqlite3 *database;
	cau_store *store = retention_open(fixture);
	assert_int_equal(cau_store_file_open(fixture->path, 1 << 20, &database, NULL), CAU_OK);
	for (uint64_t tick = 0; tick <= end; tick += cadence) {
		retention_put_checkpoint(store, 0, tick);
		do
			assert_int_equal(
				cau_store_retention_step(database, &fixture->config, &budget, &rows, &error),
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
	// at most the bytes of 41 checkpoints of 100 kB, because freed pages were used again
	assert_in_range(pages * 4096, 1, 41 * 105000);
	sqlite3_close(database);
	cau_store_close(store);
}

// Reads the counted bytes of a session's first branch, and the bytes of its log.
static void read_count(sqlite3 *database, int session, int64_t *counted, int64_t *logged)
{
	char sql[200];
	snprintf(sql, sizeof sql,
	         "SELECT bytes FROM branches JOIN sessions ON session = key WHERE id = 's%d'", session);
	assert_int_equal(cau_store_integer(database, sql, counted, NULL), CAU_OK);
	snprintf(sql, sizeof sql,
	         "SELECT sum(length(payload) + 64) FROM commands JOIN sessions ON session = key"
	         " WHERE id = 's%d'",
	         session);
	assert_int_equal(cau_store_integer(database, sql, logged, NULL), CAU_OK);
}

// Writes `ticks` ticks of each session's log. After every third tick comes a batch that fails. The
// first record of that batch is rolled back, and must not be counted.
static void write_logs(cau_store *store, int sessions, uint64_t ticks)
{
	char id[16];
	for (uint64_t tick = 0; tick < ticks; tick++)
		for (int i = 0; i < sessions; i++) {
			snprintf(id, sizeof id, "s%d", i);
			assert_int_equal(write_batch(store, command_batch(id, 0, tick), NULL), CAU_OK);
			if (tick % 3)
				continue;
			cau_store_batch *failing = command_batch(id, 0, tick + 1);
			put_tick_command(failing, id, 0, tick);
			assert_int_equal(write_batch(store, failing, NULL), CAU_ALREADY_EXISTS);
		}
}

// Runs with one session, and with more sessions than there are slots for uncounted bytes.
static void a_log_is_counted_but_for_its_newest_page(void **state)
{
	enum { MANY = 20, TICKS = 60 }; // enough sessions to exceed the slots; each tick has 72 bytes
	for (int sessions = 1; sessions <= MANY; sessions += MANY - 1) {
		struct fixture *fixture = *state;
		char id[16];
		sqlite3 *database;
		snprintf(fixture->path, sizeof fixture->path, "%s/%d.db", fixture->folder, sessions);
		cau_store *store = open_store(&fixture->config);
		for (int i = 0; i < sessions; i++) {
			snprintf(id, sizeof id, "s%d", i);
			assert_int_equal(write_batch(store, session_batch(id), NULL), CAU_OK);
		}
		write_logs(store, sessions, TICKS);
		assert_int_equal(cau_store_file_open(fixture->path, 1 << 20, &database, NULL), CAU_OK);
		for (int i = 0; i < sessions; i++) {
			int64_t counted, logged;
			read_count(database, i, &counted, &logged);
			assert_int_equal(logged, TICKS * (64 + (int)sizeof(uint64_t)));
			assert_in_range(logged - counted, 0, 4095);
		}
		sqlite3_close(database);
		cau_store_close(store);
	}
}

static void a_command_of_no_branch_fails(void **state)
{
	cau_store *store = retention_open(*state);
	assert_int_equal(write_batch(store, command_batch("knee", 0, 0), NULL), CAU_OK);
	assert_int_equal(write_batch(store, command_batch("knee", 3, 0), NULL), CAU_NOT_FOUND);
	cau_store_close(store);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_big_session_loses_left_branches_first),
		TEST(the_first_checkpoint_and_the_newest_two_stay_whatever_the_limit),
		TEST(whatever_was_rewound_tick_0_can_be_reached),
		TEST(marked_states_and_their_events_stay),
		TEST(a_log_beyond_the_limit_goes_as_a_gap_that_is_told),
		TEST(what_could_not_be_stored_is_a_gap),
		TEST(an_untouched_weekend_is_small),
		TEST(a_log_is_counted_but_for_its_newest_page),
		TEST(a_command_of_no_branch_fails),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

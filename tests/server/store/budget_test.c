// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the budget of the whole store: the oldest checkpoint of all sessions is removed first,
// marked states stay, and the daemon is notified.
#include <string.h>
#include <unistd.h>

#include "retention_fixture.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

enum { PATIENCE_MS = 30000 };

static void put(cau_store *store, const char *session, uint64_t tick, bool marked)
{
	static const char snapshot[100000];
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_checkpoint checkpoint = {
		.session = session, .tick = tick, .snapshot = {snapshot, sizeof snapshot}};
	assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
	if (marked)
		assert_int_equal(cau_store_put_mark(batch, session, 0, tick, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static cau_status note_tick(void *user, const cau_store_checkpoint *checkpoint)
{
	*(uint64_t *)user = checkpoint->tick;
	return CAU_OK;
}

// True if the session has a checkpoint at exactly this tick.
static bool has(cau_store *store, const char *session, uint64_t tick)
{
	uint64_t newest = UINT64_MAX;
	cau_store_read_checkpoint(store, session, 0, tick, note_tick, &newest, NULL);
	return newest == tick;
}

// Makes a store with checkpoints of two sessions at ticks 0 to 6000, alternating between the
// sessions. The checkpoint of "knee" at tick 1000 is marked. The checkpoints have 1.4 MB, the
// tables and indices 0.1 MB.
static cau_store *fill(struct fixture *fixture)
{
	cau_store *store = retention_open(fixture);
	assert_int_equal(write_batch(store, session_batch("hip"), NULL), CAU_OK);
	for (uint64_t tick = 0; tick <= 6000; tick += 1000) {
		put(store, "knee", tick, tick == 1000);
		put(store, "hip", tick, false);
	}
	return store;
}

static void of_all_sessions_the_oldest_goes_first(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = fill(fixture);
	fixture->config.store_bytes = 1100000;
	store = retention_retire(fixture, store, &removal);
	// the rest is 1,045 kB, so that a twentieth of the budget is free
	assert_int_equal(removal.budget.dropped, 5);
	assert_int_equal(removal.budget.state, CAU_STORE_BUDGET_KEPT);
	assert_in_range(removal.budget.bytes, 945000, 1045000);
	for (uint64_t tick = 0; tick <= 6000; tick += 1000) {
		assert_int_equal(has(store, "knee", tick), tick < 2000 || tick > 3000);
		assert_int_equal(has(store, "hip", tick), tick == 0 || tick > 3000);
	}
	cau_store_close(store);
}

static void within_its_budget_and_without_one_nothing_goes(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = fill(fixture);
	fixture->config.store_bytes = 1510000;
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 0);
	assert_in_range(removal.budget.bytes, 1400000, 1510000);
	fixture->config.store_bytes = 0;
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 0);
	assert_int_equal(removal.budget.state, CAU_STORE_BUDGET_KEPT);
	cau_store_close(store);
}

static void after_checkpoints_the_log_of_the_biggest_goes(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	static uint64_t ticks[6000];
	cau_store *store = fill(fixture);
	retention_log(store, 0, 0, 6000); // log of "knee"
	fixture->config.store_bytes = 750000;
	store = retention_retire(fixture, store, &removal);
	// 7 of 14 checkpoints are left: of each session the first and the newest two, and the marked
	// one
	assert_int_equal(removal.budget.dropped, 7);
	int left = read_ticks(store, "knee", 0, 0, 6000, ticks, 6000);
	// the log is removed from one checkpoint to the next, and the newest stays
	assert_in_range(left, 1000, 5000);
	uint64_t oldest;
	assert_int_equal(cau_store_read_oldest_tick(store, "knee", 0, &oldest, NULL), CAU_OK);
	assert_true(oldest >= 1000);
	assert_int_equal(cau_store_check_reach(store, "knee", 0, 5999, NULL), CAU_OK);
	cau_store_close(store);
}

static void what_may_not_go_is_beyond_it(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = retention_open(fixture);
	for (uint64_t tick = 0; tick <= 6000; tick += 1000)
		put(store, "knee", tick, true);
	fixture->config.store_bytes = 300000;
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(removal.rows, 0);
	assert_int_equal(removal.budget.state, CAU_STORE_BUDGET_BEYOND);
	for (uint64_t tick = 0; tick <= 6000; tick += 1000)
		assert_true(has(store, "knee", tick));
	cau_store_close(store);
}

// ---- answers
static void put_answers(cau_store *store, const char *client, uint64_t first, int count)
{
	static const char result[800];
	cau_store_batch *batch = cau_store_batch_create();
	for (int i = 0; i < count; i++) {
		cau_store_answer answer = {.client = client,
		                           .sequence = first + (uint64_t)i,
		                           .session = "knee",
		                           .result = {result, sizeof result}};
		assert_int_equal(cau_store_put_answer(batch, &answer, NULL), CAU_OK);
	}
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static cau_status ignore_answer(void *user, const cau_store_answer *answer)
{
	(void)user, (void)answer;
	return CAU_OK;
}

static cau_status look_for(cau_store *store, const char *client, uint64_t sequence)
{
	return cau_store_read_answer(store, client, sequence, ignore_answer, NULL, NULL);
}

// Answers may use a quarter of the budget. The oldest are removed first, and checkpoints stay.
static void answers_beyond_their_share_go_before_checkpoints(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = fill(fixture);
	for (int i = 0; i < 20; i++) { // the answers have 2 MB in all
		put_answers(store, "anna", 1 + 100 * (uint64_t)i, 100);
		retention_clock_ms += 1000;
	}
	fixture->config.store_bytes = 2500000;
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(removal.budget.state, CAU_STORE_BUDGET_KEPT);
	assert_int_equal(removal.budget.dropped, 0);
	assert_true(removal.budget.bytes <= 2500000);
	// The removed answer is noted as forgotten: a resend must not act again.
	assert_int_equal(look_for(store, "anna", 1), CAU_ALREADY_EXISTS);
	assert_int_equal(look_for(store, "anna", 2000), CAU_OK);
	assert_int_equal(look_for(store, "anna", 2001), CAU_NOT_FOUND);
	for (uint64_t tick = 0; tick <= 6000; tick += 1000)
		assert_true(has(store, "hip", tick));
	cau_store_close(store);
}

// Answers within their share stay, and checkpoints of sessions are removed instead.
static void answers_within_their_share_stay(void **state)
{
	struct fixture *fixture = *state;
	struct removal removal;
	cau_store *store = fill(fixture);
	put_answers(store, "anna", 1, 200); // the answers have 0.2 MB in all
	fixture->config.store_bytes = 1300000;
	store = retention_retire(fixture, store, &removal);
	assert_int_equal(removal.budget.state, CAU_STORE_BUDGET_KEPT);
	assert_true(removal.budget.dropped > 0);
	assert_int_equal(look_for(store, "anna", 1), CAU_OK);
	cau_store_close(store);
}

// ---- notices of a running store
typedef struct told {
	atomic_int count;
	cau_store_budget_state states[8];
	int64_t bytes[8], dropped[8];
} told;

static void note(void *user, cau_store_budget_state state, int64_t bytes, int64_t dropped)
{
	told *t = user;
	int i = t->count;
	if (i == 8)
		return;
	t->states[i] = state;
	t->bytes[i] = bytes;
	t->dropped[i] = dropped;
	t->count = i + 1;
}

static void the_daemon_is_told_when_it_begins_and_when_it_is_over(void **state)
{
	struct fixture *fixture = *state;
	static told heard;
	cau_store_metrics metrics;
	memset(&heard, 0, sizeof heard);
	cau_store_close(fill(fixture));
	fixture->config.store_bytes = 1100000;
	fixture->config.retention_interval_ms = 10;
	fixture->config.on_budget = note;
	fixture->config.user = &heard;
	cau_store *store = open_store(&fixture->config);
	for (int waited = 0; heard.count < 2 && waited < PATIENCE_MS; waited++)
		usleep(1000);
	assert_int_equal(heard.count, 2);
	assert_int_equal(heard.states[0], CAU_STORE_BUDGET_SHRINKING);
	assert_true(heard.bytes[0] > 1400000);
	assert_int_equal(heard.states[1], CAU_STORE_BUDGET_KEPT);
	assert_true(heard.bytes[1] <= 1045000);
	assert_int_equal(heard.dropped[1], 5);
	cau_store_get_metrics(store, &metrics);
	assert_int_equal(metrics.budget_dropped, 5);
	assert_int_equal(metrics.kept_bytes, heard.bytes[1]);
	assert_int_equal(metrics.budget, CAU_STORE_BUDGET_KEPT);
	cau_store_close(store);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(of_all_sessions_the_oldest_goes_first),
		TEST(within_its_budget_and_without_one_nothing_goes),
		TEST(after_checkpoints_the_log_of_the_biggest_goes),
		TEST(what_may_not_go_is_beyond_it),
		TEST(answers_beyond_their_share_go_before_checkpoints),
		TEST(answers_within_their_share_stay),
		TEST(the_daemon_is_told_when_it_begins_and_when_it_is_over),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

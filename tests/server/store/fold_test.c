// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that the write-ahead log stays near its bound during writing without a pause.
#include "store_fixture.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

enum {
	BOUND_BYTES = 500000,
	SNAPSHOT_BYTES = 100000,
	COUNT = 200,
	// Most bytes of the write-ahead log. Commits wait for a fold from four times the bound on, and
	// the last group may go beyond that.
	MOST_BYTES = 4 * BOUND_BYTES + 10 * SNAPSHOT_BYTES,
};

static void the_log_stays_near_its_bound(void **state)
{
	struct fixture *fixture = *state;
	static const char snapshot[SNAPSHOT_BYTES];
	cau_store_metrics metrics;
	fixture->config.wal_bytes = BOUND_BYTES;
	fixture->config.commit_delay_ms = 0;
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	for (uint64_t tick = 0; tick < COUNT; tick++) {
		cau_store_batch *batch = cau_store_batch_create();
		cau_store_checkpoint checkpoint = {
			.session = "knee", .tick = tick, .snapshot = {snapshot, sizeof snapshot}};
		assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
		assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
		cau_store_get_metrics(store, &metrics);
		assert_in_range(metrics.wal_bytes, 0, MOST_BYTES);
	}
	// most of the log has been folded
	assert_true(metrics.database_bytes > COUNT * SNAPSHOT_BYTES / 2);
	cau_store_close(store);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(the_log_stays_near_its_bound),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

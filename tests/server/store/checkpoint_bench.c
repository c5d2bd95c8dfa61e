// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the time from submission to answer of a checkpoint of 4 MB, and of a small request that
// is submitted with the checkpoint.
#include "store_fixture.h"

#include <stdlib.h>

#include "store/store_state.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

enum { COUNT = 100, SNAPSHOT_BYTES = 4000000 };

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static void report(const char *what, double seconds[COUNT])
{
	qsort(seconds, COUNT, sizeof *seconds, compare);
	print_message("%s, ms: p50 %.2f, p99 %.2f, worst %.2f (%d)\n", what, 1e3 * seconds[COUNT / 2],
	              1e3 * seconds[COUNT * 99 / 100 - 1], 1e3 * seconds[COUNT - 1], COUNT);
}

static void four_megabyte_checkpoints(void **state)
{
	struct fixture *fixture = *state;
	double checkpoint_s[COUNT], request_s[COUNT];
	unsigned char *snapshot = malloc(SNAPSHOT_BYTES);
	unsigned random = 1;
	for (int i = 0; i < SNAPSHOT_BYTES; i++)
		snapshot[i] = (unsigned char)rand_r(&random);
	fixture->config.commit_delay_ms = 0;
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	for (uint64_t i = 0; i < COUNT; i++) {
		cau_store_batch *batch = cau_store_batch_create();
		cau_store_checkpoint checkpoint = {
			.session = "knee", .tick = i, .snapshot = {snapshot, SNAPSHOT_BYTES}};
		assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
		double start_s = cau_store_monotonic_s();
		assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
		checkpoint_s[i] = cau_store_monotonic_s() - start_s;
		start_s = cau_store_monotonic_s();
		assert_int_equal(write_batch(store, command_batch("knee", 0, i), NULL), CAU_OK);
		request_s[i] = cau_store_monotonic_s() - start_s;
	}
	report("checkpoint of 4 MB", checkpoint_s);
	report("request right behind it", request_s);
	cau_store_metrics metrics;
	cau_store_get_metrics(store, &metrics);
	assert_int_equal(metrics.batches, 1 + 2 * COUNT);
	assert_true(metrics.commit_p99_s > 0.0);
	cau_store_close(store);
	free(snapshot);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(four_megabyte_checkpoints),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

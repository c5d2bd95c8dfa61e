// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a store in memory: it keeps the same records, has no file, and leaves nothing when it is
// closed.
#include "store_fixture.h"

#include <dirent.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

enum { ROUNDS = 400, SNAPSHOT_BYTES = 1 << 20, SNAPSHOTS = 100 };

static cau_store *open_memory(void **state, int64_t most)
{
	struct fixture *fixture = *state;
	fixture->config.path = NULL;
	fixture->config.memory = true;
	fixture->config.commit_delay_ms = 0;
	fixture->config.store_bytes = most;
	return open_store(&fixture->config);
}

static cau_status count_session(void *user, const cau_store_session *session)
{
	(void)session;
	++*(int *)user;
	return CAU_OK;
}

static int count_sessions(cau_store *store)
{
	int count = 0;
	assert_int_equal(cau_store_read_sessions(store, count_session, &count, NULL), CAU_OK);
	return count;
}

static void rows_are_there_until_it_is_closed(void **state)
{
	uint64_t ticks[8];
	cau_store *store = open_memory(state, 0);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	for (uint64_t tick = 0; tick < 5; tick++)
		assert_int_equal(write_batch(store, command_batch("knee", 0, tick), NULL), CAU_OK);
	assert_int_equal(read_ticks(store, "knee", 0, 0, 10, ticks, 8), 5);
	assert_int_equal(count_sessions(store), 1);
	cau_store_close(store);
	store = open_memory(state, 0);
	assert_int_equal(count_sessions(store), 0);
	cau_store_close(store);
}

static void two_know_nothing_of_each_other_and_make_no_file(void **state)
{
	struct fixture *fixture = *state;
	cau_store *one = open_memory(state, 0), *other = open_memory(state, 0);
	assert_int_equal(write_batch(one, session_batch("knee"), NULL), CAU_OK);
	assert_int_equal(count_sessions(other), 0);
	int files = 0;
	DIR *folder = opendir(fixture->folder);
	while (readdir(folder))
		files++;
	closedir(folder);
	assert_int_equal(files, 2); // the folder has only . and ..
	cau_store_close(one);
	cau_store_close(other);
}

typedef struct reader {
	cau_store *store;
	atomic_bool over;
	int readings, failures;
} reader;

static void *read_on(void *context)
{
	reader *of = context;
	while (!of->over) {
		int count = 0;
		of->failures += cau_store_read_sessions(of->store, count_session, &count, NULL) != CAU_OK;
		of->readings++;
	}
	return NULL;
}

static void readers_and_the_writer_wait_for_each_other(void **state)
{
	reader of = {.store = open_memory(state, 0)};
	pthread_t thread;
	assert_int_equal(write_batch(of.store, session_batch("knee"), NULL), CAU_OK);
	assert_int_equal(pthread_create(&thread, NULL, read_on, &of), 0);
	for (uint64_t tick = 0; tick < ROUNDS; tick++)
		assert_int_equal(write_batch(of.store, command_batch("knee", 0, tick), NULL), CAU_OK);
	of.over = true;
	pthread_join(thread, NULL);
	assert_int_equal(of.failures, 0);
	assert_true(of.readings > 0);
	cau_store_close(of.store);
}

static void it_keeps_within_its_bytes(void **state)
{
	const int64_t most = 20 * SNAPSHOT_BYTES;
	cau_store *store = open_memory(state, most);
	char *snapshot = calloc(1, SNAPSHOT_BYTES);
	cau_store_metrics metrics;
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	for (uint64_t tick = 0; tick < SNAPSHOTS; tick++) {
		cau_store_checkpoint row = {
			.session = "knee", .tick = 1000 * tick, .snapshot = {snapshot, SNAPSHOT_BYTES}};
		cau_store_batch *batch = cau_store_batch_create();
		assert_int_equal(cau_store_put_checkpoint(batch, &row, NULL), CAU_OK);
		assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	}
	cau_store_get_metrics(store, &metrics);
	assert_true(metrics.kept_bytes > 0 && metrics.kept_bytes <= (uint64_t)most * 11 / 10);
	cau_store_close(store);
	free(snapshot);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(rows_are_there_until_it_is_closed),
		TEST(two_know_nothing_of_each_other_and_make_no_file),
		TEST(readers_and_the_writer_wait_for_each_other),
		TEST(it_keeps_within_its_bytes),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

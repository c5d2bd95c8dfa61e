// SPDX-License-Identifier: GPL-3.0-or-later
#include "retention_fixture.h"

#include <sqlite3.h>

#include "store/file.h"
#include "store/retention.h"

_Atomic int64_t retention_clock_ms;

static int64_t test_clock_ms(void)
{
	return retention_clock_ms;
}

cau_store *retention_open(struct fixture *fixture)
{
	retention_clock_ms = RETENTION_START_MS;
	fixture->config.wall_clock_ms = test_clock_ms;
	fixture->config.retention_interval_ms = INT32_MAX; // the test takes the steps itself
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	return store;
}

void retention_log(cau_store *store, int64_t branch, uint64_t from, uint64_t before)
{
	cau_store_batch *batch = cau_store_batch_create();
	for (uint64_t tick = from; tick < before; tick++)
		put_tick_command(batch, "knee", branch, tick);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

void retention_put_checkpoint(cau_store *store, int64_t branch, uint64_t tick)
{
	static const char snapshot[100000];
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_checkpoint checkpoint = {
		.session = "knee", .branch = branch, .tick = tick, .snapshot = {snapshot, sizeof snapshot}};
	assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

cau_status retention_open_branch(cau_store *store, int64_t branch, int64_t parent,
                                 uint64_t fork_tick)
{
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_branch opened = {
		.session = "knee", .branch = branch, .parent = parent, .fork_tick = fork_tick};
	assert_int_equal(cau_store_put_branch(batch, &opened, NULL), CAU_OK);
	return write_batch(store, batch, NULL);
}

cau_store *retention_retire(struct fixture *fixture, cau_store *store, struct removal *removal)
{
	sqlite3 *database;
	int64_t rows;
	struct cau_store_budget budget = {0};
	*removal = (struct removal){0};
	cau_store_close(store);
	assert_int_equal(cau_store_file_open(fixture->path, 1 << 20, &database, NULL), CAU_OK);
	do {
		cau_error error = {0};
		if (cau_store_retention_step(database, &fixture->config, &budget, &rows, &error))
			fail_msg("%s", error.reason);
		removal->rows += rows;
		removal->steps += rows > 0;
		if (rows > removal->most)
			removal->most = rows;
	} while (rows);
	removal->budget = budget;
	sqlite3_close(database);
	return open_store(&fixture->config);
}

int retention_count_log(cau_store *store, int64_t branch)
{
	static uint64_t ticks[5000];
	int count = read_ticks(store, "knee", branch, 0, 100000, ticks, 5000);
	for (int i = 0; i < count; i++)
		assert_int_equal(ticks[i], i); // the log is complete from the start
	return count;
}

static cau_status see_tick(void *user, const cau_store_checkpoint *checkpoint)
{
	*(int64_t *)user = (int64_t)checkpoint->tick;
	return CAU_OK;
}

int64_t retention_newest_checkpoint(cau_store *store, int64_t branch, uint64_t tick)
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

int retention_count_branches(cau_store *store)
{
	int count = 0;
	assert_int_equal(cau_store_read_branches(store, "knee", count_branch, &count, NULL), CAU_OK);
	return count;
}

cau_status retention_count_event(void *user, const cau_store_event *event)
{
	(void)event;
	++*(int *)user;
	return CAU_OK;
}

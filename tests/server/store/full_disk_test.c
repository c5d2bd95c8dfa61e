// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a disk that is really full: a small tmpfs in a mount namespace of the test, filled by a
// ballast file. The test needs root and is skipped otherwise.
#include "store_fixture.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <time.h>
#include <unistd.h>

#include "store/store_state.h"

enum {
	SNAPSHOT_BYTES = 500000,
	RETRY_MS = 20,
	PATIENCE_S = 20, // longest wait for a recovery, s; a recovery takes a few RETRY_MS
};

// ---- the disk -------------------------------------------------------------------------
static int mount_disk(void **state)
{
	struct fixture *fixture;
	if (fixture_setup(state))
		return -1;
	fixture = *state;
	return mount("tmpfs", fixture->folder, "tmpfs", 0, "size=8m");
}

static int unmount_disk(void **state)
{
	const struct fixture *fixture = *state;
	int code = umount(fixture->folder);
	return fixture_teardown(state) || code;
}

static void ballast_path(const struct fixture *fixture, char path[256])
{
	snprintf(path, 256, "%s/ballast", fixture->folder);
}

// Fills all the free space.
static void fill_disk(const struct fixture *fixture)
{
	static const char block[4096] = {1};
	char path[256];
	ballast_path(fixture, path);
	int descriptor = open(path, O_WRONLY | O_CREAT | O_APPEND, 0600);
	assert_true(descriptor >= 0);
	while (write(descriptor, block, sizeof block) > 0)
		;
	assert_int_equal(errno, ENOSPC);
	close(descriptor);
}

static void free_disk(const struct fixture *fixture)
{
	char path[256];
	ballast_path(fixture, path);
	assert_int_equal(unlink(path), 0);
}

// ---- the store's state ----------------------------------------------------------------
struct watch {
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	cau_store_state state;
	int changes;
};

static void see_state(void *user, cau_store_state state, const char *reason)
{
	struct watch *watch = user;
	assert_true(state == CAU_STORE_READY || reason[0]);
	pthread_mutex_lock(&watch->mutex);
	watch->state = state;
	watch->changes++;
	pthread_cond_broadcast(&watch->changed);
	pthread_mutex_unlock(&watch->mutex);
}

static void await_state(struct watch *watch, cau_store_state state)
{
	struct timespec end;
	clock_gettime(CLOCK_REALTIME, &end);
	end.tv_sec += PATIENCE_S;
	pthread_mutex_lock(&watch->mutex);
	while (watch->state != state)
		assert_int_equal(pthread_cond_timedwait(&watch->changed, &watch->mutex, &end), 0);
	pthread_mutex_unlock(&watch->mutex);
}

static cau_store *open_watched(struct fixture *fixture, struct watch *watch)
{
	*watch =
		(struct watch){PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, CAU_STORE_READY, 0};
	fixture->config.full_retry_ms = RETRY_MS;
	fixture->config.on_state = see_state;
	fixture->config.user = watch;
	return open_store(&fixture->config);
}

// Returns a batch with one command and one checkpoint: half a megabyte that must be stored
// completely or not at all.
static cau_store_batch *big_batch(uint64_t tick)
{
	static const char snapshot[SNAPSHOT_BYTES];
	cau_store_batch *batch = command_batch("knee", 0, tick);
	cau_store_checkpoint checkpoint = {
		.session = "knee", .tick = tick, .snapshot = {snapshot, sizeof snapshot}};
	assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
	return batch;
}

// Writes until the disk refuses. Returns the tick that failed.
static uint64_t write_until_full(cau_store *store, uint64_t tick)
{
	char reason[320];
	for (;; tick++) {
		cau_status status = write_batch(store, big_batch(tick), reason);
		if (status) {
			assert_int_equal(status, CAU_IO);
			assert_non_null(strstr(reason, "full"));
			return tick;
		}
		assert_true(tick < 100); // the disk has only 8 MB
	}
}

static void expect_ticks(cau_store *store, const uint64_t *expected, int count)
{
	uint64_t ticks[200];
	assert_int_equal(read_ticks(store, "knee", 0, 0, 1000, ticks, 200), count);
	assert_memory_equal(ticks, expected, (size_t)count * sizeof *expected);
}

// ---- tests ----------------------------------------------------------------------------
static void a_full_disk_refuses_and_recovers(void **state)
{
	struct fixture *fixture = *state;
	struct watch watch;
	cau_store_health health;
	cau_error error = {0};
	uint64_t expected[200];
	int count = 0;
	cau_store *store = open_watched(fixture, &watch);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	for (uint64_t tick = 0; tick < 3; tick++)
		assert_int_equal(write_batch(store, big_batch(tick), NULL), CAU_OK);
	fill_disk(fixture);
	uint64_t failed = write_until_full(store, 3);
	while ((uint64_t)count < failed)
		expected[count] = (uint64_t)count, count++;

	// A full store reports its state, refuses at once, still reads, and tries again only at the
	// configured rate.
	await_state(&watch, CAU_STORE_FULL);
	cau_store_get_health(store, &health);
	assert_int_equal(health.state, CAU_STORE_FULL);
	assert_non_null(strstr(health.reason, "full"));
	cau_store_batch *refused = command_batch("knee", 0, 500);
	assert_int_equal(cau_store_submit(store, refused, NULL, NULL, &error), CAU_IO);
	assert_string_equal(error.reason, health.reason);
	expect_ticks(store, expected, count);
	cau_store_metrics before, after;
	double start_s = cau_store_monotonic_s();
	cau_store_get_metrics(store, &before);
	do // the loop ends once a few more attempts have been made
		cau_store_get_metrics(store, &after);
	while (after.full_attempts < before.full_attempts + 5);
	double took_s = cau_store_monotonic_s() - start_s;
	// 0.9, because the first attempt may have been under way
	assert_true(took_s > 4 * 1e-3 * RETRY_MS * 0.9);
	assert_int_equal(after.full_count, 1);

	free_disk(fixture);
	await_state(&watch, CAU_STORE_READY);
	assert_int_equal(write_batch(store, refused, NULL), CAU_OK);
	expected[count++] = 500;
	expect_ticks(store, expected, count);
	cau_store_close(store);
	store = open_store(&fixture->config);
	expect_ticks(store, expected, count);
	cau_store_close(store);
}

static void a_full_disk_can_fill_again_and_a_full_store_can_be_closed(void **state)
{
	struct fixture *fixture = *state;
	struct watch watch;
	uint64_t ticks[200];
	cau_store *store = open_watched(fixture, &watch);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	int count = 0;
	for (int round = 0; round < 3; round++) {
		fill_disk(fixture);
		uint64_t first = 100 * (uint64_t)round;
		// The count includes batches that still fitted into the log.
		count += (int)(write_until_full(store, first) - first);
		await_state(&watch, CAU_STORE_FULL);
		free_disk(fixture);
		await_state(&watch, CAU_STORE_READY);
		assert_int_equal(write_batch(store, command_batch("knee", 0, first + 99), NULL), CAU_OK);
		count++;
	}
	assert_int_equal(watch.changes, 6);
	fill_disk(fixture);
	write_until_full(store, 300);
	cau_store_close(store);
	free_disk(fixture);
	store = open_store(&fixture->config);
	assert_true(read_ticks(store, "knee", 0, 0, 300, ticks, 200) == count);
	cau_store_close(store);
}

static void a_store_cannot_be_made_on_a_full_disk(void **state)
{
	struct fixture *fixture = *state;
	cau_store *store = NULL;
	cau_error error = {0};
	fill_disk(fixture);
	assert_int_equal(cau_store_open(&fixture->config, &store, &error), CAU_IO);
	assert_int_equal(access(fixture->path, F_OK), -1);
	free_disk(fixture);
	cau_store_close(open_store(&fixture->config));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, mount_disk, unmount_disk)

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_full_disk_refuses_and_recovers),
		TEST(a_full_disk_can_fill_again_and_a_full_store_can_be_closed),
		TEST(a_store_cannot_be_made_on_a_full_disk),
	};
	if (unshare(CLONE_NEWNS) || mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL)) {
		printf("skipped: a small disk cannot be mounted here (%s)\n", strerror(errno));
		return 77;
	}
	return cmocka_run_group_tests(tests, NULL, NULL);
}

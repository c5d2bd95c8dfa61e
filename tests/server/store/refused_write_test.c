// SPDX-License-Identifier: GPL-3.0-or-later
// Tests writes that the system refuses for another reason than a full disk: a limit on file size,
// which the process sets for itself and removes again. Also tests a file that is damaged under a
// running store.
#include "store_fixture.h"

#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "store/store_state.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

static void limit_files(rlim_t bytes)
{
	struct rlimit limit;
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
	limit.rlim_cur = bytes < limit.rlim_max ? bytes : limit.rlim_max;
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static cau_store_batch *checkpoint_batch(uint64_t tick)
{
	static const char snapshot[200000];
	cau_store_batch *batch = command_batch("knee", 0, tick);
	cau_store_checkpoint checkpoint = {
		.session = "knee", .tick = tick, .snapshot = {snapshot, sizeof snapshot}};
	assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
	return batch;
}

struct tally {
	int ok, io, other;
};

static void count_status(void *user, cau_status status, const char *reason)
{
	struct tally *tally = user;
	assert_true(status == CAU_OK || reason[0]);
	tally->ok += status == CAU_OK;
	tally->io += status == CAU_IO;
	tally->other += status != CAU_OK && status != CAU_IO;
}

static void a_refused_write_fails_what_waits_and_recovers(void **state)
{
	struct fixture *fixture = *state;
	// longest wait for a recovery, s; a recovery takes a few of the 10 ms between attempts
	static const double patience_s = 20.0;
	struct tally tally = {0};
	cau_store_health health;
	uint64_t ticks[64];
	char reason[320];
	fixture->config.full_retry_ms = 10;
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	assert_int_equal(write_batch(store, checkpoint_batch(1), NULL), CAU_OK);

	limit_files(150000); // this is less than one snapshot, even when the log is empty
	int accepted = 0;
	for (uint64_t tick = 2; tick < 12; tick++) {
		cau_store_batch *batch = checkpoint_batch(tick);
		if (cau_store_submit(store, batch, count_status, &tally, NULL))
			cau_store_batch_destroy(batch);
		else
			accepted++;
	}
	cau_store_flush(store);
	limit_files(RLIM_INFINITY);
	assert_true(accepted > 0);
	assert_int_equal(tally.io, accepted); // no batch fits
	assert_int_equal(tally.other, 0);

	double end_s = cau_store_monotonic_s() + patience_s;
	do {
		cau_store_get_health(store, &health);
		assert_true(cau_store_monotonic_s() < end_s);
	} while (health.state != CAU_STORE_READY);
	if (write_batch(store, checkpoint_batch(20), reason))
		fail_msg("%s", reason);
	cau_store_close(store);
	store = open_store(&fixture->config);
	assert_int_equal(read_ticks(store, "knee", 0, 0, 100, ticks, 64), 2);
	assert_int_equal(ticks[0], 1);
	assert_int_equal(ticks[1], 20);
	cau_store_close(store);
}

// Overwrites all but the file's first page, in a child process. Closing a descriptor of the file in
// this process would drop SQLite's locks on it.
static void damage(const char *path)
{
	pid_t child = fork();
	assert_true(child >= 0);
	if (child == 0) {
		static const unsigned char garbage[4096] = {0xba, 0xad, 0xf0, 0x0d};
		int descriptor = open(path, O_WRONLY);
		off_t end = lseek(descriptor, 0, SEEK_END);
		for (off_t at = 4096; at < end; at += 4096)
			if (pwrite(descriptor, garbage, sizeof garbage, at) != sizeof garbage)
				_exit(1);
		_exit(0);
	}
	int status;
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_int_equal(status, 0);
}

static void damage_found_while_running_is_final(void **state)
{
	struct fixture *fixture = *state;
	cau_store_health health;
	cau_error error = {0};
	char reason[320];
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	assert_int_equal(write_batch(store, checkpoint_batch(1), NULL), CAU_OK);
	cau_store_close(store);
	store = open_store(&fixture->config); // a new store has nothing in its cache
	damage(fixture->path);
	assert_int_equal(write_batch(store, checkpoint_batch(2), reason), CAU_CORRUPT);
	cau_store_get_health(store, &health);
	assert_int_equal(health.state, CAU_STORE_DAMAGED);
	assert_string_equal(health.reason, reason);
	cau_store_batch *batch = checkpoint_batch(3);
	assert_int_equal(cau_store_submit(store, batch, NULL, NULL, &error), CAU_CORRUPT);
	cau_store_batch_destroy(batch);
	cau_store_close(store);
	assert_int_equal(cau_store_open(&fixture->config, &store, &error), CAU_CORRUPT);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_refused_write_fails_what_waits_and_recovers),
		TEST(damage_found_while_running_is_final),
	};
	// a write beyond the limit then returns EFBIG, and no signal ends the process
	signal(SIGXFSZ, SIG_IGN);
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a kill -9 at any moment loses nothing that was acknowledged. A child process writes
// batches, and sends the tick of each acknowledged batch through a pipe. The parent kills the child
// and checks the store.
#include "store_fixture.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

enum {
	ROUNDS = 20,
	IN_FLIGHT = 32,      // batches that the child keeps waiting
	SNAPSHOT_EVERY = 16, // batches between two snapshots
	// bytes of a snapshot; so large that many kills occur during a long write or a fold of the log
	SNAPSHOT_BYTES = 300000,
	MOST_ACKS = 400, // most acknowledgements that the parent waits for in a round
	// longest delay before the kill, us, so that kills also occur at other moments than right after
	// an acknowledgement
	MOST_DELAY_US = 3000,
	MAX_TICKS = 100000,
};

// ---- the child ------------------------------------------------------------------------
struct writer {
	int pipe;
	pthread_mutex_t mutex;
	pthread_cond_t answered;
	int in_flight;
	uint64_t next_acknowledged; // ticks are acknowledged in this order
};

static void acknowledge(void *user, cau_status status, const char *reason)
{
	struct writer *writer = user;
	(void)reason;
	pthread_mutex_lock(&writer->mutex);
	uint64_t tick = writer->next_acknowledged++;
	writer->in_flight--;
	pthread_cond_signal(&writer->answered);
	pthread_mutex_unlock(&writer->mutex);
	if (status || write(writer->pipe, &tick, sizeof tick) != sizeof tick)
		_exit(3);
}

static cau_store_batch *numbered_batch(uint64_t tick)
{
	static const char snapshot[SNAPSHOT_BYTES];
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_command command = {
		.session = "knee",
		.tick = tick,
		.kind = 3,
		.payload = {&tick, sizeof tick},
		.client = "writer",
		.sequence = tick,
		.result = {&tick, sizeof tick},
	};
	cau_store_checkpoint checkpoint = {
		.session = "knee", .tick = tick, .hash = tick, .snapshot = {snapshot, sizeof snapshot}};
	if (cau_store_put_command(batch, &command, NULL))
		_exit(4);
	if (tick % SNAPSHOT_EVERY == 0 && cau_store_put_checkpoint(batch, &checkpoint, NULL))
		_exit(4);
	return batch;
}

static _Noreturn void write_forever(const cau_store_config *config, uint64_t tick, int pipe)
{
	struct writer writer = {pipe, PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, 0, tick};
	cau_store *store;
	if (cau_store_open(config, &store, NULL))
		_exit(2);
	for (;; tick++) {
		pthread_mutex_lock(&writer.mutex);
		while (writer.in_flight == IN_FLIGHT)
			pthread_cond_wait(&writer.answered, &writer.mutex);
		writer.in_flight++;
		pthread_mutex_unlock(&writer.mutex);
		if (cau_store_submit(store, numbered_batch(tick), acknowledge, &writer, NULL))
			_exit(5);
	}
}

// ---- the parent -----------------------------------------------------------------------
// Reads `wanted` acknowledgements, kills the child, then reads those still in the pipe. Returns the
// first tick that was not acknowledged.
static uint64_t run_until_killed(const cau_store_config *config, uint64_t first, int wanted,
                                 long delay_us)
{
	int ends[2], status;
	uint64_t tick, next = first;
	assert_int_equal(pipe(ends), 0);
	pid_t child = fork();
	assert_true(child >= 0);
	if (child == 0) {
		close(ends[0]);
		write_forever(config, first, ends[1]);
	}
	close(ends[1]);
	for (int i = 0; i < wanted; i++) {
		assert_int_equal(read(ends[0], &tick, sizeof tick), sizeof tick);
		assert_int_equal(tick, next++);
	}
	// A delay without any condition, so that the kill can occur at any moment.
	nanosleep(&(struct timespec){.tv_nsec = delay_us * 1000}, NULL);
	assert_int_equal(kill(child, SIGKILL), 0);
	while (read(ends[0], &tick, sizeof tick) == sizeof tick)
		assert_int_equal(tick, next++);
	close(ends[0]);
	assert_int_equal(waitpid(child, &status, 0), child);
	// the child did not end by its own failure
	assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
	return next;
}

static cau_status see_checkpoint(void *user, const cau_store_checkpoint *checkpoint)
{
	assert_int_equal(checkpoint->snapshot.bytes, SNAPSHOT_BYTES);
	assert_true(checkpoint->hash == checkpoint->tick);
	*(uint64_t *)user = checkpoint->tick;
	return CAU_OK;
}

static cau_status see_answer(void *user, const cau_store_answer *answer)
{
	assert_memory_equal(answer->result.data, user, sizeof(uint64_t));
	return CAU_OK;
}

// Checks that every command before `acknowledged` is in the store, in order, and that no command is
// missing among the later commands. Returns the number of commands.
static uint64_t check_store(const cau_store_config *config, uint64_t acknowledged)
{
	static uint64_t ticks[MAX_TICKS];
	uint64_t newest = 0;
	cau_store *store = open_store(config);
	int count = read_ticks(store, "knee", 0, 0, INT64_MAX, ticks, MAX_TICKS);
	assert_true((uint64_t)count >= acknowledged);
	assert_true((uint64_t)count <= acknowledged + IN_FLIGHT);
	for (int i = 0; i < count; i++)
		assert_int_equal(ticks[i], i);
	uint64_t last = (uint64_t)count - 1;
	assert_int_equal(cau_store_read_answer(store, "writer", last, see_answer, &last, NULL), CAU_OK);
	assert_int_equal(
		cau_store_read_checkpoint(store, "knee", 0, last, see_checkpoint, &newest, NULL), CAU_OK);
	assert_int_equal(newest, last - last % SNAPSHOT_EVERY);
	cau_store_close(store);
	return (uint64_t)count;
}

static void kill_9_loses_nothing_acknowledged(void **state)
{
	struct fixture *fixture = *state;
	const char *given = getenv("CAU_TEST_SEED");
	unsigned seed = given ? (unsigned)strtoul(given, NULL, 0) : (unsigned)time(NULL);
	uint64_t count = 0, acknowledged_sum = 0;
	print_message("CAU_TEST_SEED=%u\n", seed);
	fixture->config.commit_delay_ms = 1;
	fixture->config.wal_bytes = 1000000;       // the log is folded every few snapshots
	fixture->config.retention_bytes = 3000000; // this limit is small, so that retention works too
	fixture->config.retention_interval_ms = 1;
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	cau_store_close(store);
	for (int round = 0; round < ROUNDS; round++) {
		int wanted = 1 + rand_r(&seed) % MOST_ACKS;
		uint64_t acknowledged =
			run_until_killed(&fixture->config, count, wanted, rand_r(&seed) % MOST_DELAY_US);
		acknowledged_sum += acknowledged - count;
		count = check_store(&fixture->config, acknowledged);
	}
	print_message("%d kills, %llu acknowledged, all there\n", ROUNDS,
	              (unsigned long long)acknowledged_sum);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(kill_9_loses_nothing_acknowledged),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

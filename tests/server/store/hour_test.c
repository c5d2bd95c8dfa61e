// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a store that takes 2,000 requests a second stays within its budget. All its records
// count, also the answers. The test has its own clock; requests are written as fast as the disk
// takes them. The argument is the number of minutes: two by default, one under sanitizers.
#include <semaphore.h>
#include <stdlib.h>
#include <string.h>

#include "store_fixture.h"

enum {
	REQUESTS_PER_S = 2000,
	TICKS_PER_S = 60,
	CHECKPOINT_S = 10, // time between two checkpoints, as in the daemon's settings
	CLIENTS = 8,
	BUDGET_BYTES = 20000000,
	WAL_BYTES = 1000000, // limit of the log; small, so that the file's size shows the used part
};

static int minutes = CAU_TEST_SANITIZED ? 1 : 2;
static _Atomic int64_t clock_ms = 1700000000000;
static sem_t committed; // posted once for each committed batch

static int64_t test_clock_ms(void)
{
	return clock_ms;
}

// Adds a request. Payload and result are as long as those of tool.move.
static void put_request(cau_store_batch *batch, uint64_t tick, uint64_t number)
{
	static const char payload[80] = "{}", result[100] = "{}";
	char client[32];
	snprintf(client, sizeof client, "client-%u", (unsigned)(number % CLIENTS));
	cau_store_command command = {.session = "knee",
	                             .tick = tick,
	                             .order = (uint32_t)(number % REQUESTS_PER_S),
	                             .kind = 3,
	                             .payload = {payload, sizeof payload},
	                             .client = client,
	                             .sequence = number,
	                             .result = {result, sizeof result}};
	assert_int_equal(cau_store_put_command(batch, &command, NULL), CAU_OK);
}

static void put_checkpoint(cau_store_batch *batch, uint64_t tick)
{
	static const char snapshot[200000];
	cau_store_checkpoint checkpoint = {
		.session = "knee", .tick = tick, .hash = tick, .snapshot = {snapshot, sizeof snapshot}};
	assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
}

static void count_failure(void *user, cau_status status, const char *reason)
{
	(void)reason;
	*(_Atomic int *)user += status != CAU_OK;
	sem_post(&committed);
}

static void submit(cau_store *store, cau_store_batch *batch, _Atomic int *failed)
{
	cau_status status;
	while ((status = cau_store_submit(store, batch, count_failure, failed, NULL)) == CAU_LIMIT)
		sem_wait(&committed); // the batches that fill the queue will be committed
	assert_int_equal(status, CAU_OK);
}

static cau_status ignore_answer(void *user, const cau_store_answer *answer)
{
	(void)user, (void)answer;
	return CAU_OK;
}

static void the_budget_holds_for_an_hour_of_requests(void **state)
{
	struct fixture *fixture = *state;
	_Atomic int failed = 0;
	sem_init(&committed, 0, 0);
	uint64_t number = 0, most = 0, ticks = (uint64_t)minutes * 60 * TICKS_PER_S;
	cau_store_metrics metrics;
	fixture->config.store_bytes = BUDGET_BYTES;
	fixture->config.wal_bytes = WAL_BYTES;
	// at most ten ticks wait for a commit
	fixture->config.queue_batches = TICKS_PER_S / 6;
	fixture->config.wall_clock_ms = test_clock_ms;
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	for (uint64_t tick = 0; tick < ticks; tick++) {
		cau_store_batch *batch = cau_store_batch_create();
		if (tick % (CHECKPOINT_S * TICKS_PER_S) == 0)
			put_checkpoint(batch, tick);
		while (number < (tick + 1) * REQUESTS_PER_S / TICKS_PER_S)
			put_request(batch, tick, ++number);
		submit(store, batch, &failed);
		clock_ms += 1000 / TICKS_PER_S;
		cau_store_get_metrics(store, &metrics);
		most = metrics.database_bytes > most ? metrics.database_bytes : most;
	}
	cau_store_flush(store);
	print_message("%llu requests; the file had %.1f MB at most, with a budget of %.1f\n",
	              (unsigned long long)number, 1e-6 * (double)most, 1e-6 * BUDGET_BYTES);
	assert_int_equal(failed, 0);
	assert_true((double)most <= 1.2 * BUDGET_BYTES);
	// The answer to the newest request is still stored. The oldest request has no answer, but is
	// known to have acted.
	char client[32];
	snprintf(client, sizeof client, "client-%u", (unsigned)(number % CLIENTS));
	assert_int_equal(cau_store_read_answer(store, client, number, ignore_answer, NULL, NULL),
	                 CAU_OK);
	assert_int_equal(cau_store_read_answer(store, "client-1", 1, ignore_answer, NULL, NULL),
	                 CAU_ALREADY_EXISTS);
	cau_store_close(store);
	sem_destroy(&committed);
}

int main(int argc, char **argv)
{
	if (argc > 1)
		minutes = atoi(argv[1]);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(the_budget_holds_for_an_hour_of_requests, fixture_setup,
	                                    fixture_teardown),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests groups, the order of answers, and the bound on waiting batches. A callback that waits at a
// gate stops the store thread, so that the test knows exactly which batches wait behind it.
#include "store_fixture.h"

#include <pthread.h>
#include <sched.h>
#include <string.h>

struct gate {
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	bool reached, open;
};

static void wait_at_gate(void *user, cau_status status, const char *reason)
{
	struct gate *gate = user;
	(void)reason;
	assert_int_equal(status, CAU_OK);
	pthread_mutex_lock(&gate->mutex);
	gate->reached = true;
	pthread_cond_broadcast(&gate->changed);
	while (!gate->open)
		pthread_cond_wait(&gate->changed, &gate->mutex);
	pthread_mutex_unlock(&gate->mutex);
}

// Makes session "knee" and leaves the store thread waiting at the gate.
static void hold(cau_store *store, struct gate *gate)
{
	*gate = (struct gate){PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, false, false};
	assert_int_equal(cau_store_submit(store, session_batch("knee"), wait_at_gate, gate, NULL),
	                 CAU_OK);
	pthread_mutex_lock(&gate->mutex);
	while (!gate->reached)
		pthread_cond_wait(&gate->changed, &gate->mutex);
	pthread_mutex_unlock(&gate->mutex);
}

static void let_go(struct gate *gate)
{
	pthread_mutex_lock(&gate->mutex);
	gate->open = true;
	pthread_cond_broadcast(&gate->changed);
	pthread_mutex_unlock(&gate->mutex);
}

struct order {
	int next;
	cau_status status[2000];
};
struct ticket {
	struct order *order;
	int number;
};

static void take_ticket(void *user, cau_status status, const char *reason)
{
	struct ticket *ticket = user;
	(void)reason;
	assert_int_equal(ticket->number, ticket->order->next);
	ticket->order->status[ticket->order->next++] = status;
}

static void what_queues_up_is_one_commit_answered_in_order(void **state)
{
	struct fixture *fixture = *state;
	static struct order order;
	static struct ticket ticket[500];
	struct gate gate;
	cau_store_metrics before, after;
	cau_store *store = open_store(&fixture->config);
	memset(&order, 0, sizeof order);
	hold(store, &gate);
	cau_store_get_metrics(store, &before);
	for (int i = 0; i < 500; i++) {
		ticket[i] = (struct ticket){&order, i};
		assert_int_equal(cau_store_submit(store, command_batch("knee", 0, (uint64_t)i), take_ticket,
		                                  &ticket[i], NULL),
		                 CAU_OK);
	}
	let_go(&gate);
	cau_store_flush(store);
	cau_store_get_metrics(store, &after);
	assert_int_equal(order.next, 500);
	for (int i = 0; i < 500; i++)
		assert_int_equal(order.status[i], CAU_OK);
	assert_int_equal(after.commits, before.commits + 1);
	// bucket 9 is for groups of 257 to 512 batches
	assert_int_equal(after.group_size[9], before.group_size[9] + 1);
	assert_int_equal(after.batches, 501);
	assert_int_equal(after.records, 501);
	assert_int_equal(after.queue_batches, 0);
	assert_int_equal(after.queue_bytes, 0);
	assert_true(after.commit_p50_s > 0.0 && after.commit_p99_s >= after.commit_p50_s);
	assert_true(after.database_bytes > 0 && after.wal_bytes > 0);
	uint64_t ticks[500];
	assert_int_equal(read_ticks(store, "knee", 0, 0, 1000, ticks, 500), 500);
	for (int i = 0; i < 500; i++)
		assert_int_equal(ticks[i], i);
	cau_store_close(store);
}

static void a_bad_batch_fails_whole_and_alone(void **state)
{
	struct fixture *fixture = *state;
	static struct order order;
	struct ticket ticket[4];
	struct gate gate;
	cau_store *store = open_store(&fixture->config);
	memset(&order, 0, sizeof order);
	hold(store, &gate);
	cau_store_batch *batch[4] = {
		command_batch("knee", 0, 1),
		command_batch("knee", 0, 2), // tick 1 comes a second time below
		command_batch("elbow", 0, 3),
		command_batch("knee", 0, 4),
	};
	put_tick_command(batch[1], "knee", 0, 1);
	for (int i = 0; i < 4; i++) {
		ticket[i] = (struct ticket){&order, i};
		assert_int_equal(cau_store_submit(store, batch[i], take_ticket, &ticket[i], NULL), CAU_OK);
	}
	let_go(&gate);
	cau_store_flush(store);
	assert_int_equal(order.status[0], CAU_OK);
	assert_int_equal(order.status[1], CAU_ALREADY_EXISTS);
	assert_int_equal(order.status[2], CAU_NOT_FOUND);
	assert_int_equal(order.status[3], CAU_OK);
	uint64_t ticks[4];
	assert_int_equal(read_ticks(store, "knee", 0, 0, 100, ticks, 4), 2);
	assert_int_equal(ticks[0], 1);
	assert_int_equal(ticks[1], 4);
	cau_store_health health;
	cau_store_get_health(store, &health);
	assert_int_equal(health.state, CAU_STORE_READY);
	cau_store_close(store);
}

static void a_full_queue_refuses_and_keeps_what_it_has(void **state)
{
	struct fixture *fixture = *state;
	static struct order order;
	static struct ticket ticket[16];
	struct gate gate;
	cau_error error;
	fixture->config.queue_batches = 10;
	cau_store *store = open_store(&fixture->config);
	memset(&order, 0, sizeof order);
	hold(store, &gate);
	for (int i = 0; i < 10; i++) {
		ticket[i] = (struct ticket){&order, i};
		assert_int_equal(cau_store_submit(store, command_batch("knee", 0, (uint64_t)i), take_ticket,
		                                  &ticket[i], NULL),
		                 CAU_OK);
	}
	cau_store_batch *late = command_batch("knee", 0, 10);
	assert_int_equal(cau_store_submit(store, late, NULL, NULL, &error), CAU_LIMIT);
	assert_non_null(strstr(error.reason, "10 batches"));
	let_go(&gate);
	cau_store_flush(store);
	assert_int_equal(order.next, 10);
	// after the refusal the batch still belonged to the test
	assert_int_equal(write_batch(store, late, NULL), CAU_OK);
	uint64_t ticks[16];
	assert_int_equal(read_ticks(store, "knee", 0, 0, 100, ticks, 16), 11);
	cau_store_metrics metrics;
	cau_store_get_metrics(store, &metrics);
	assert_int_equal(metrics.refused_batches, 1);
	cau_store_close(store);
}

static void bytes_are_bounded_too(void **state)
{
	struct fixture *fixture = *state;
	static const char zeros[60000];
	struct gate gate;
	cau_error error;
	fixture->config.queue_bytes = 100000;
	cau_store *store = open_store(&fixture->config);
	hold(store, &gate);
	cau_store_batch *batch[2];
	for (int i = 0; i < 2; i++) {
		cau_store_checkpoint checkpoint = {
			.session = "knee", .tick = (uint64_t)i, .snapshot = {zeros, sizeof zeros}};
		batch[i] = cau_store_batch_create();
		assert_int_equal(cau_store_put_checkpoint(batch[i], &checkpoint, NULL), CAU_OK);
	}
	assert_int_equal(cau_store_submit(store, batch[0], NULL, NULL, &error), CAU_OK);
	assert_int_equal(cau_store_submit(store, batch[1], NULL, NULL, &error), CAU_LIMIT);
	let_go(&gate);
	cau_store_flush(store);
	assert_int_equal(write_batch(store, batch[1], NULL), CAU_OK);
	cau_store_close(store);
}

static void close_drains(void **state)
{
	struct fixture *fixture = *state;
	static struct order order;
	static struct ticket ticket[100];
	struct gate gate;
	cau_store *store = open_store(&fixture->config);
	memset(&order, 0, sizeof order);
	hold(store, &gate);
	for (int i = 0; i < 100; i++) {
		ticket[i] = (struct ticket){&order, i};
		assert_int_equal(cau_store_submit(store, command_batch("knee", 0, (uint64_t)i), take_ticket,
		                                  &ticket[i], NULL),
		                 CAU_OK);
	}
	let_go(&gate);
	cau_store_close(store);
	assert_int_equal(order.next, 100);
	store = open_store(&fixture->config);
	uint64_t ticks[100];
	assert_int_equal(read_ticks(store, "knee", 0, 0, 1000, ticks, 100), 100);
	cau_store_close(store);
}

struct submitter {
	cau_store *store;
	uint64_t first;
};

static void *submit_many(void *context)
{
	const struct submitter *submitter = context;
	for (uint64_t i = 0; i < 200; i++)
		assert_int_equal(cau_store_submit(submitter->store,
		                                  command_batch("knee", 0, submitter->first + i), NULL,
		                                  NULL, NULL),
		                 CAU_OK);
	cau_store_flush(submitter->store);
	return NULL;
}

static void many_threads_submit_flush_and_look(void **state)
{
	struct fixture *fixture = *state;
	pthread_t thread[4];
	struct submitter submitter[4];
	uint64_t ticks[800];
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	for (int i = 0; i < 4; i++) {
		submitter[i] = (struct submitter){store, 1000 * (uint64_t)i};
		assert_int_equal(pthread_create(&thread[i], NULL, submit_many, &submitter[i]), 0);
	}
	for (int i = 0; i < 20; i++) { // the main thread reads while the four threads submit
		cau_store_metrics metrics;
		cau_store_get_metrics(store, &metrics);
		assert_true(read_ticks(store, "knee", 0, 0, 10000, ticks, 800) <= 800);
	}
	for (int i = 0; i < 4; i++)
		pthread_join(thread[i], NULL);
	assert_int_equal(read_ticks(store, "knee", 0, 0, 10000, ticks, 800), 800);
	cau_store_close(store);
}

static void it_moves_unless_a_commit_hangs(void **state)
{
	struct fixture *fixture = *state;
	struct gate gate;
	cau_store *store = open_store(&fixture->config);
	for (int round = 0; round < 3; round++)
		while (!cau_store_moves(store)) // cau_store_moves asks the thread to look; the thread then
		                                // looks without another wake
			sched_yield();
	hold(store, &gate);
	cau_store_moves(store);
	for (int asked = 0; asked < 1000; asked++)
		assert_false(cau_store_moves(store));
	let_go(&gate);
	while (!cau_store_moves(store))
		sched_yield();
	cau_store_close(store);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(what_queues_up_is_one_commit_answered_in_order),
		TEST(a_bad_batch_fails_whole_and_alone),
		TEST(a_full_queue_refuses_and_keeps_what_it_has),
		TEST(bytes_are_bounded_too),
		TEST(it_moves_unless_a_commit_hangs),
		TEST(close_drains),
		TEST(many_threads_submit_flush_and_look),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

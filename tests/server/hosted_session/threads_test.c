// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a session among threads. First, losses are timed to meet each moment on the way of an
// enable exactly. Then losses come at random.
#include "server/hosted_session/threads_world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static void assert_all_well(void)
{
	threads_await_answers();
	threads_await_steps(2);
	cau_store_flush(threads.store); // by now a second answer to a request would have come
	for (int i = 0; i < threads.request_count; i++)
		assert_int_equal(threads.requests[i].answers, 1);
	pthread_mutex_lock(&threads.lock);
	if (threads.wrongs)
		fail_msg("%llu times; first: %s", (unsigned long long)threads.wrongs, threads.wrong);
	pthread_mutex_unlock(&threads.lock);
}

// Makes an enable meet a loss: the session's thread or the store's thread stops at the moment `at`.
static request *enable_meets(moment at, loss kind)
{
	request *enable = NULL;
	threads.wanted = (int)at;
	if (at != WAITING)
		enable = threads_energize(0, 0, true);
	pthread_barrier_wait(&threads.met);
	if (at == WAITING)
		enable = threads_energize(0, 0, true);
	threads_lose(kind, 0);
	pthread_barrier_wait(&threads.over);
	return enable;
}

static uint64_t energized_ticks(void)
{
	pthread_mutex_lock(&threads.lock);
	uint64_t ticks = threads.tools[0].energized_ticks;
	pthread_mutex_unlock(&threads.lock);
	return ticks;
}

static void assert_a_loss_holds(moment at, loss kind)
{
	assert_true(threads_done(threads_take_over(0, 0)));
	request *enable = enable_meets(at, kind);
	bool taken = threads_done(enable);
	assert_true(at != WAITING || !taken || kind == OFF_BY_ANOTHER);
	assert_true(at <= TAKEN || taken);
	threads_await_steps(2); // waits for the tick that had begun, and one more
	uint64_t ticks = energized_ticks();
	threads_await_steps(3);
	assert_int_equal(energized_ticks(), ticks);
	if (at <= APPLIED)
		assert_int_equal(ticks, 0);
	if (kind == FULL_STORE)
		cau_hosted_store_takes(threads.h, true, NULL);
	assert_true(threads_done(threads_take_over(0, 0)));
	assert_true(threads_done(threads_energize(0, 0, true)));
	threads_await_steps(2); // check_tool checks the first of these ticks
	assert_true(energized_ticks() > ticks);
	assert_true(threads_done(threads_energize(1, 0, false)));
	pthread_mutex_lock(&threads.lock);
	threads.tools[0].energized_ticks = 0;
	pthread_mutex_unlock(&threads.lock);
}

static void a_loss_holds_at_every_moment_of_an_enable(void **state)
{
	(void)state;
	for (int at = WAITING; at < MOMENT_COUNT; at++)
		for (int kind = 0; kind < LOSS_COUNT; kind++) {
			assert_a_loss_holds((moment)at, (loss)kind);
			assert_all_well();
		}
}

static uint64_t next_random(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return *state >> 33;
}

static void await_turn(int client)
{
	pthread_mutex_lock(&threads.lock);
	while (threads.in_flight[client] >= IN_FLIGHT)
		pthread_cond_wait(&threads.changed, &threads.lock);
	pthread_mutex_unlock(&threads.lock);
}

// Pauses and resumes the session. A pause is never refused. A resume is refused while the store is
// full.
static void pause_and_resume(int client)
{
	threads_ask(client, CAU_ORDER_PAUSE, CAU_METHOD_SESSION_PAUSE, 0);
	while (!threads_done(threads_ask(client, CAU_ORDER_RESUME, CAU_METHOD_SESSION_RESUME, 0))) {
		pthread_mutex_lock(&threads.lock);
		while (threads.full)
			pthread_cond_wait(&threads.changed, &threads.lock);
		pthread_mutex_unlock(&threads.lock);
	}
}

// Notes whether the store has capacity. Threads that wait for capacity are woken after the session
// was notified.
static void tell_room(bool room)
{
	if (room)
		cau_hosted_store_takes(threads.h, true, NULL);
	pthread_mutex_lock(&threads.lock);
	threads.full = !room;
	pthread_cond_broadcast(&threads.changed);
	pthread_mutex_unlock(&threads.lock);
}

static void ask_something(int client, uint64_t *random)
{
	int tool = (int)(next_random(random) % TOOLS);
	uint64_t what = next_random(random) % 100;
	if (what < 35) {
		threads_energize(client, tool, true);
	} else if (what < 50) {
		threads_energize(client, tool, false);
	} else if (what < 75) {
		threads_move(client, tool, 1e-4 * (double)(next_random(random) % 100));
	} else if (what < 96) {
		threads_take_over(client, tool);
	} else if (what < 99) {
		pause_and_resume(client);
	} else { // the client is silent for longer than its deadline
		threads_await_steps(20);
	}
}

static void *ask_at_random(void *user)
{
	int client = *(int *)user;
	uint64_t random = 71 + (uint64_t)client;
	for (int i = 0; i < ROUNDS; i++) {
		await_turn(client);
		ask_something(client, &random);
	}
	return NULL;
}

static void *lose_at_random(void *user)
{
	uint64_t random = 5;
	(void)user;
	while (!threads.ended) {
		threads_await_steps(1 + next_random(&random) % 4);
		// waits a random time within a tick
		for (uint64_t i = next_random(&random) % 512; i > 0; i--)
			atomic_thread_fence(memory_order_seq_cst);
		int client = (int)(next_random(&random) % CLIENTS);
		uint64_t what = next_random(&random) % 10;
		if (what < 5) {
			threads_lose(CUT, client);
		} else if (what < 8) {
			threads_lose(FORGET, client);
		} else {
			tell_room(false);
			threads_lose(FULL_STORE, client);
			tell_room(true);
		}
	}
	return NULL;
}

static void *watch(void *user)
{
	(void)user;
	while (!threads.ended) {
		cau_hosted_watch(threads.h, cau_monotonic_s());
		cau_hosted_feed(threads.h, 1, cau_monotonic_s());
		threads_await_steps(1);
	}
	return NULL;
}

static void nothing_is_energized_after_its_loss_whatever_comes_when(void **state)
{
	(void)state;
	int clients[CLIENTS] = {0, 1};
	pthread_t asking[CLIENTS], losing, watching;
	pthread_create(&losing, NULL, lose_at_random, NULL);
	pthread_create(&watching, NULL, watch, NULL);
	for (int i = 0; i < CLIENTS; i++)
		pthread_create(&asking[i], NULL, ask_at_random, &clients[i]);
	for (int i = 0; i < CLIENTS; i++)
		pthread_join(asking[i], NULL);
	threads_await_answers();
	threads_await_steps(2); // two more steps, while losses still happen
	pthread_mutex_lock(&threads.lock);
	threads.ended = true;
	pthread_cond_broadcast(&threads.changed);
	pthread_mutex_unlock(&threads.lock);
	pthread_join(losing, NULL);
	pthread_join(watching, NULL);
	assert_all_well();
	pthread_mutex_lock(&threads.lock);
	uint64_t least = threads.tools[0].energized_ticks;
	for (int i = 1; i < TOOLS; i++)
		least = threads.tools[i].energized_ticks < least ? threads.tools[i].energized_ticks : least;
	pthread_mutex_unlock(&threads.lock);
	assert_true(least > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_loss_holds_at_every_moment_of_an_enable, threads_begin,
	                                    threads_end),
		cmocka_unit_test_setup_teardown(nothing_is_energized_after_its_loss_whatever_comes_when,
	                                    threads_begin, threads_end),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

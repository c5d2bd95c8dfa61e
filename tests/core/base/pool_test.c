// SPDX-License-Identifier: GPL-3.0-or-later
// Every part runs once, for any number of threads, in very many loops.
#include "base/pool.h"

#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

enum { LOOPS = 100000, PARTS = 300, MANY_PARTS = 65535 };

typedef struct tally {
	int32_t count[MANY_PARTS];
} tally;

static void count_part(void *context, int32_t index)
{
	tally *work = context;
	work->count[index]++; // each part has its own cell, so no lock is needed if each part runs once
}

static void test_every_part_once(void **state)
{
	(void)state;
	static const int32_t threads[] = {1, 2, 3, 7, 16};
	static const int32_t parts[] = {0, 1, 2, 3, 5, 16, 63, PARTS};
	static tally work;
	for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
		cau_pool *pool = cau_pool_create(threads[t]);
		assert_non_null(pool);
		assert_int_equal(cau_pool_thread_count(pool), threads[t]);
		for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
			memset(&work, 0, sizeof work);
			for (int32_t loop = 1; loop <= 50; loop++) {
				cau_pool_run(pool, parts[k], count_part, &work);
				for (int32_t i = 0; i < PARTS + 1; i++)
					assert_int_equal(work.count[i], i < parts[k] ? loop : 0);
			}
		}
		cau_pool_destroy(pool);
	}
}

static void test_the_most_parts(void **state)
{
	(void)state;
	static tally work;
	memset(&work, 0, sizeof work);
	cau_pool *pool = cau_pool_create(2);
	cau_pool_run(pool, MANY_PARTS, count_part, &work);
	for (int32_t i = 0; i < MANY_PARTS; i++)
		assert_int_equal(work.count[i], 1);
	cau_pool_destroy(pool);
}

// Values that one loop writes are read in other parts of the next loop: a sum that passes from part
// to part.
typedef struct chain {
	int64_t value[2][4];
	int32_t from;
} chain;

static void hand_on(void *context, int32_t index)
{
	chain *work = context;
	work->value[!work->from][index] = work->value[work->from][(index + 1) % 4] + index;
}

static void test_loops_follow_each_other(void **state)
{
	(void)state;
	static const int32_t threads[] = {2, 3};
	for (size_t t = 0; t < 2; t++) {
		chain work = {0}, expected = {0};
		cau_pool *pool = cau_pool_create(threads[t]);
		for (int32_t loop = 0; loop < LOOPS; loop++) {
			work.from = expected.from = loop & 1;
			cau_pool_run(pool, 4, hand_on, &work);
			for (int32_t i = 0; i < 4; i++)
				hand_on(&expected, i);
		}
		assert_memory_equal(work.value, expected.value, sizeof work.value);
		cau_pool_destroy(pool);
	}
	cau_pool_destroy(NULL);
}

// A helper that loses its core in the middle of a part, as on a machine that other programs use.
typedef struct stall {
	pthread_t caller;
	_Atomic int stalled, by_helpers;
} stall;

// Time, ns, that a helper stalls. It is much longer than a loop takes, so that the caller finishes
// its own parts meanwhile.
static const long stall_ns = 50000000;

static void stall_once(void *context, int32_t index)
{
	stall *work = context;
	(void)index;
	if (pthread_equal(pthread_self(), work->caller)) {
		for (int i = 0; i < 1000 && !atomic_load(&work->stalled); i++)
			sched_yield(); // yields, so that the helper gets a part
		return;
	}
	atomic_fetch_add(&work->by_helpers, 1);
	if (!atomic_exchange(&work->stalled, 1))
		// the stall: the helper sleeps in its part
		nanosleep(&(struct timespec){.tv_nsec = stall_ns}, NULL);
}

// Runs loops until the helper has stalled in one. From then on the caller works alone.
static void run_into_a_stall(cau_pool *pool, stall *work)
{
	for (int loop = 0; loop < 100000 && !work->stalled; loop++)
		cau_pool_run(pool, 4, stall_once, work);
	assert_int_equal(work->stalled, 1);
	atomic_store(&work->by_helpers, 0);
}

// After a helper stalled, the caller does some thousand parts alone. Then it shares parts again.
static void test_a_stalled_helper_is_left_out_for_a_while(void **state)
{
	(void)state;
	stall work = {.caller = pthread_self()};
	cau_pool *pool = cau_pool_create(2);
	run_into_a_stall(pool, &work);
	for (int loop = 0; loop < 1000; loop++)
		cau_pool_run(pool, 4, stall_once, &work);
	assert_int_equal(work.by_helpers, 0);
	for (int loop = 0; loop < 1000000 && !work.by_helpers; loop++)
		cau_pool_run(pool, 4, stall_once, &work);
	assert_true(work.by_helpers > 0);
	cau_pool_destroy(pool);
}

// PATIENCE_MS: longest time that the caller sleeps in its first part, until the helper has had a
// part. Even in a shared loop the helper may need that long to get a core.
enum { PATIENCE_MS = 500, LONG_LOOPS = 6 };

static void wait_for_a_helper(void *context, int32_t index)
{
	stall *work = context;
	if (!pthread_equal(pthread_self(), work->caller))
		atomic_fetch_add(&work->by_helpers, 1);
	else if (index == 0)
		for (int ms = 0; ms < PATIENCE_MS && !atomic_load(&work->by_helpers); ms++)
			nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
}

// LONG_LOOPS long loops are enough for the caller to share parts again. The caller works alone for
// a number of parts, not of loops. If loops were counted, a large session, whose loops are long,
// would need thousands of them.
static void test_long_loops_are_shared_again_as_soon(void **state)
{
	(void)state;
	stall work = {.caller = pthread_self()};
	cau_pool *pool = cau_pool_create(2);
	run_into_a_stall(pool, &work);
	for (int loop = 0; loop < LONG_LOOPS && !work.by_helpers; loop++)
		cau_pool_run(pool, MANY_PARTS, wait_for_a_helper, &work);
	assert_true(work.by_helpers > 0);
	cau_pool_destroy(pool);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_every_part_once),
		cmocka_unit_test(test_the_most_parts),
		cmocka_unit_test(test_loops_follow_each_other),
		cmocka_unit_test(test_a_stalled_helper_is_left_out_for_a_while),
		cmocka_unit_test(test_long_loops_are_shared_again_as_soon),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

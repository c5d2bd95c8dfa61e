// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/pool.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { JOBS = 2000 };

typedef struct job {
	pthread_mutex_t gate; // locked by the test while the job must not end
	int64_t value;
	pthread_t thread;
} job;

static void run(void *context)
{
	job *work = context;
	pthread_mutex_lock(&work->gate);
	work->value = 3 * work->value + 1;
	work->thread = pthread_self();
	pthread_mutex_unlock(&work->gate);
}

static void test_jobs_run_in_order_and_are_waited_for(void **state)
{
	(void)state;
	cau_background *background = cau_background_create();
	assert_non_null(background);
	cau_background_wait(background); // returns at once without a job
	job work = {.gate = PTHREAD_MUTEX_INITIALIZER, .value = 1};
	int64_t expected = 1;
	for (int i = 0; i < JOBS; i++) {
		if (i % 39 == 0) // start again before the value overflows
			work.value = 1, expected = 1;
		cau_background_start(background, run, &work);
		cau_background_wait(background);
		expected = 3 * expected + 1;
		assert_int_equal(work.value, expected); // the job's writes are visible without a lock
	}
	assert_false(pthread_equal(work.thread, pthread_self()));
	cau_background_destroy(background);
}

// cau_background_start returns before the job ends: the caller still holds the lock that the job
// needs.
static void test_start_does_not_wait(void **state)
{
	(void)state;
	cau_background *background = cau_background_create();
	job work = {.gate = PTHREAD_MUTEX_INITIALIZER, .value = 5};
	pthread_mutex_lock(&work.gate);
	cau_background_start(background, run, &work);
	assert_int_equal(work.value, 5);
	pthread_mutex_unlock(&work.gate);
	cau_background_wait(background);
	assert_int_equal(work.value, 16);
	cau_background_destroy(background);
}

static void test_destroy_waits_for_the_job(void **state)
{
	(void)state;
	for (int i = 0; i < 200; i++) {
		cau_background *background = cau_background_create();
		job work = {.gate = PTHREAD_MUTEX_INITIALIZER, .value = 2};
		cau_background_start(background, run, &work);
		cau_background_destroy(background);
		assert_int_equal(work.value, 7);
	}
	cau_background_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_jobs_run_in_order_and_are_waited_for),
		cmocka_unit_test(test_start_does_not_wait),
		cmocka_unit_test(test_destroy_waits_for_the_job),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/builder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static cau_job job_of(double expected_s)
{
	return (cau_job){.expected_s = expected_s};
}

static void the_shortest_goes_first(void **state)
{
	(void)state;
	cau_job_queue queue = {0};
	cau_job long_one = job_of(3), middle = job_of(1), short_one = job_of(0.1);
	cau_job_queue_put(&queue, &long_one, 10);
	cau_job_queue_put(&queue, &middle, 10.5);
	cau_job_queue_put(&queue, &short_one, 11);
	assert_int_equal(queue.count, 3);
	assert_ptr_equal(cau_job_queue_take(&queue), &short_one);
	assert_ptr_equal(cau_job_queue_take(&queue), &middle);
	assert_ptr_equal(cau_job_queue_take(&queue), &long_one);
	assert_null(cau_job_queue_take(&queue));
	assert_int_equal(queue.count, 0);
}

static void equals_keep_their_order(void **state)
{
	(void)state;
	cau_job_queue queue = {0};
	cau_job jobs[4];
	for (int i = 0; i < 4; i++) {
		jobs[i] = job_of(0.2);
		cau_job_queue_put(&queue, &jobs[i], 5);
	}
	for (int i = 0; i < 4; i++)
		assert_ptr_equal(cau_job_queue_take(&queue), &jobs[i]);
}

// Tests that a long job gets its turn while short jobs keep coming: after those that come within
// its patience.
static void nothing_starves(void **state)
{
	(void)state;
	enum { SHORT_JOBS = 100 };
	cau_job_queue queue = {0};
	cau_job long_one = job_of(2), jobs[SHORT_JOBS];
	int before = 0;
	cau_job_queue_put(&queue, &long_one, 0);
	// A short job comes every 0.3 s.
	for (int i = 0; i < SHORT_JOBS; i++) {
		jobs[i] = job_of(0.1);
		cau_job_queue_put(&queue, &jobs[i], 0.3 * i);
		if (cau_job_queue_take(&queue) == &long_one)
			break;
		before++;
	}
	// The long job's rank is 0 + 4 x 2; the short jobs' ranks are 0.3 i + 4 x 0.1.
	assert_int_equal(before, 26);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_shortest_goes_first),
		cmocka_unit_test(equals_keep_their_order),
		cmocka_unit_test(nothing_starves),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

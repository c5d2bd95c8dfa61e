// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the buckets of a histogram, and that threads do not lose each other's counts.
#include "metrics/exposition.h"

#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { THREADS = 4, NOTES = 20000 };

static cau_histogram shared;

static int bucket_of(double seconds)
{
	cau_histogram one = {0};
	uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1];
	double sum_s;
	int found = -1;
	cau_histogram_note(&one, seconds);
	cau_histogram_read(&one, counts, &sum_s);
	for (int i = 0; i <= CAU_HISTOGRAM_BOUNDS; i++)
		if (counts[i]) {
			assert_int_equal(counts[i], 1);
			assert_int_equal(found, -1);
			found = i;
		}
	return found;
}

static void a_duration_counts_in_the_least_bucket_that_holds_it(void **state)
{
	(void)state;
	for (int i = 0; i < CAU_HISTOGRAM_BOUNDS; i++) {
		double end_s = cau_histogram_bounds_s[i];
		assert_true(i == 0 || end_s > cau_histogram_bounds_s[i - 1]);
		assert_int_equal(bucket_of(end_s), i);
		assert_int_equal(bucket_of(nextafter(end_s, INFINITY)), i + 1);
	}
	assert_int_equal(bucket_of(-1), 0);
	assert_int_equal(bucket_of(NAN), 0);
	assert_int_equal(bucket_of(1e6), CAU_HISTOGRAM_BOUNDS);
}

static void *note_many(void *argument)
{
	(void)argument;
	for (int i = 0; i < NOTES; i++)
		cau_histogram_note(&shared, 0.001 * (i % 4));
	return NULL;
}

static void threads_lose_nothing(void **state)
{
	(void)state;
	pthread_t threads[THREADS];
	uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1], total = 0;
	double sum_s;
	for (int i = 0; i < THREADS; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, note_many, NULL), 0);
	for (int i = 0; i < THREADS; i++)
		pthread_join(threads[i], NULL);
	cau_histogram_read(&shared, counts, &sum_s);
	for (int i = 0; i <= CAU_HISTOGRAM_BOUNDS; i++)
		total += counts[i];
	assert_int_equal(total, THREADS * NOTES);
	assert_true(fabs(sum_s - 0.0015 * THREADS * NOTES) < 1e-6 * THREADS * NOTES);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_duration_counts_in_the_least_bucket_that_holds_it),
		cmocka_unit_test(threads_lose_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

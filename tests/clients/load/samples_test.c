// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/load.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static void percentiles_are_those_of_the_nearest_rank(void **state)
{
	(void)state;
	load_samples samples = {0};
	for (int i = 10000; i >= 1; i--) // descending, so that the values must be sorted
		load_samples_add(&samples, i);
	assert_true(load_samples_percentile(&samples, 0.5) == 5000);
	assert_true(load_samples_percentile(&samples, 0.99) == 9900);
	assert_true(load_samples_percentile(&samples, 1) == 10000);
	assert_true(load_samples_percentile(&samples, 0) == 1);
	load_samples_add(&samples, 20000); // values may be added after sorting
	assert_true(load_samples_percentile(&samples, 1) == 20000);
	assert_int_equal(samples.count, 10001);
	assert_int_equal(samples.lost, 0);
	load_samples_finish(&samples);
}

static void of_nothing_nothing_is_known(void **state)
{
	(void)state;
	load_samples samples = {0};
	assert_true(isnan(load_samples_percentile(&samples, 0.5)));
	load_samples_finish(&samples);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(percentiles_are_those_of_the_nearest_rank),
		cmocka_unit_test(of_nothing_nothing_is_known),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

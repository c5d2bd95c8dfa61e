// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/robot.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double bin_width = 1.1; // upper edge of a bin over its lower edge

static void quantiles_are_within_a_bin(void **state)
{
	(void)state;
	robot_histogram h = {0};
	for (int i = 1; i <= 1000; i++)
		robot_histogram_add(&h, 1e-5 * i);
	const double shares[] = {0.01, 0.5, 0.9, 0.99};
	for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
		double exact_s = 1e-2 * shares[i], got_s = robot_histogram_quantile(&h, shares[i]);
		assert_true(got_s >= exact_s && got_s <= exact_s * bin_width);
	}
	assert_true(robot_histogram_quantile(&h, 1) == 1e-2);
	assert_true(h.most_s == 1e-2);
}

static void extremes_are_counted(void **state)
{
	(void)state;
	robot_histogram h = {0};
	assert_true(robot_histogram_quantile(&h, 0.5) == 0);
	robot_histogram_add(&h, 0);
	robot_histogram_add(&h, -1);
	robot_histogram_add(&h, 1e9);
	assert_int_equal(h.count, 3);
	assert_int_equal(h.bins[0], 2);
	assert_int_equal(h.bins[ROBOT_BINS - 1], 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(quantiles_are_within_a_bin),
		cmocka_unit_test(extremes_are_counted),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

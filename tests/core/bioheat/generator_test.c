// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a generator keeps its power within its limits of voltage and current.
#include "bioheat/current.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bar.h"

static const cau_generator cut = {
	.power_w = 30, .peak_v = 420, .current_a = 1.5, .crest_factor = 1.4};

static void power_is_constant_over_a_band(void **state)
{
	(void)state;
	for (double ohm = 14; ohm < 2900; ohm *= 1.1)
		assert_near(cau_generator_into(&cut, 1 / ohm).power_w, 30, 1e-9);
}

static void a_small_load_meets_the_limit_of_current(void **state)
{
	(void)state;
	cau_output output = cau_generator_into(&cut, 1 / 4.0);
	assert_near(output.current_a, 1.5, 1e-12);
	assert_near(output.power_w, 1.5 * 1.5 * 4, 1e-9);
}

static void a_great_load_meets_the_limit_of_voltage(void **state)
{
	(void)state;
	cau_output output = cau_generator_into(&cut, 1 / 9000.0);
	assert_near(output.voltage_v, 300, 1e-9);
	assert_near(output.power_w, 300.0 * 300 / 9000, 1e-9);
	assert_near(cau_generator_into(&cut, 0).power_w, 0, 0);
	assert_near(cau_generator_into(&cut, 0).voltage_v, 300, 1e-9);
}

// A sine that is on for a share D of the time has the crest factor sqrt(2 / D). So the crest factor
// determines how long the generator is on: always at 1.41, half of the time at 2, and 6 % at 5.8.
static void the_crest_factor_says_the_duty(void **state)
{
	(void)state;
	static const double duties[] = {1, 0.8, 0.5, 0.25, 0.06};
	for (size_t k = 0; k < sizeof duties / sizeof duties[0]; k++) {
		double squares = 0;
		enum { SAMPLES = 100000, PERIODS = 1000 };
		for (int i = 0; i < SAMPLES; i++) {
			double at = (i + 0.5) * PERIODS / SAMPLES;
			bool on = at < duties[k] * PERIODS;
			squares += on ? pow(420 * sin(2 * acos(-1.0) * at), 2) : 0;
		}
		double root_mean_square = sqrt(squares / SAMPLES), crest = sqrt(2 / duties[k]);
		cau_generator burst = cut;
		burst.crest_factor = crest;
		assert_near(420 / root_mean_square, crest, 1e-3);
		assert_near(cau_generator_into(&burst, 0).voltage_v, root_mean_square, 0.3);
	}
}

// The range of loads that get the set power ends at the limits of voltage and current.
static void the_band_follows_from_the_limits(void **state)
{
	(void)state;
	double least_ohm = 30 / (1.5 * 1.5), most_ohm = 300.0 * 300 / 30;
	assert_near(cau_generator_into(&cut, 1 / (1.001 * least_ohm)).power_w, 30, 1e-9);
	assert_near(cau_generator_into(&cut, 1 / (0.99 * least_ohm)).power_w, 29.7, 1e-9);
	assert_near(cau_generator_into(&cut, 1 / (0.999 * most_ohm)).power_w, 30, 1e-9);
	assert_near(cau_generator_into(&cut, 1 / (1.01 * most_ohm)).power_w, 30 / 1.01, 1e-9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(power_is_constant_over_a_band),
		cmocka_unit_test(a_small_load_meets_the_limit_of_current),
		cmocka_unit_test(a_great_load_meets_the_limit_of_voltage),
		cmocka_unit_test(the_crest_factor_says_the_duty),
		cmocka_unit_test(the_band_follows_from_the_limits),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

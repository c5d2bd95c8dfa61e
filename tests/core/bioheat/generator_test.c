// SPDX-License-Identifier: GPL-3.0-or-later
// A generator keeps its power between its limits of voltage and current.
#include "bioheat/generator.h"

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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(power_is_constant_over_a_band),
		cmocka_unit_test(a_small_load_meets_the_limit_of_current),
		cmocka_unit_test(a_great_load_meets_the_limit_of_voltage),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

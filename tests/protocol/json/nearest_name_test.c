// SPDX-License-Identifier: GPL-3.0-or-later
#include "json/nearest_name.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const char *const names[] = {"poisson_ratio", "young_modulus_pa", "density_kg_m3", "limit",
                                    "limit_stiffness_pa"};
enum { COUNT = sizeof names / sizeof *names };

static void finds_slips(void **state)
{
	(void)state;
	assert_string_equal(cau_nearest_name("posson_ratio", names, COUNT), "poisson_ratio");
	assert_string_equal(cau_nearest_name("poisson_raito", names, COUNT), "poisson_ratio");
	assert_string_equal(cau_nearest_name("youngModulusPa", names, COUNT), "young_modulus_pa");
	assert_string_equal(cau_nearest_name("Limit", names, COUNT), "limit");
	assert_string_equal(cau_nearest_name("density", names, COUNT), "density_kg_m3");
}

static void does_not_guess_wildly(void **state)
{
	(void)state;
	assert_null(cau_nearest_name("temperature_c", names, COUNT));
	assert_null(cau_nearest_name("x", names, COUNT));
	assert_null(cau_nearest_name("", names, COUNT));
	assert_null(cau_nearest_name("limit", names, 0));
	assert_null(
		cau_nearest_name("limit_limit_limit_limit_limit_limit_limit_limit_limit", names, COUNT));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_slips),
		cmocka_unit_test(does_not_guess_wildly),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

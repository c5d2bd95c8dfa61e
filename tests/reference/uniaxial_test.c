// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/uniaxial.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "reference/stress.h"

enum { CAPACITY = 64 };

// Largest error of a stress, relative to E: double rounding, with a margin for the cancellation in
// J - alpha.
static const double STRESS_TOLERANCE = 1e-12;

static void test_rows_are_the_closed_form(void **state)
{
	(void)state;
	cau_reference_uniaxial rows[CAPACITY];
	int32_t count = 0;
	cau_error error = {0};
	cau_status status = cau_reference_uniaxial_read(CAU_TEST_REFERENCE "/uniaxial.txt", CAPACITY,
	                                                rows, &count, &error);
	assert_int_equal(status, CAU_OK);
	assert_int_equal(count, 55);
	for (int32_t i = 0; i < count; ++i) {
		const cau_reference_uniaxial *row = &rows[i];
		double l = row->lateral_stretch, f[3][3] = {{row->stretch, 0, 0}, {0, l, 0}, {0, 0, l}};
		double stress[3][3], tolerance = STRESS_TOLERANCE * row->young_modulus_pa;
		cau_reference_stress(row->model, row->young_modulus_pa, row->poisson_ratio, f, stress);
		assert_true(fabs(stress[0][0] - row->stress_pa) < tolerance);
		assert_true(fabs(stress[1][1]) < tolerance);
		assert_true(fabs(stress[2][2]) < tolerance);
	}
}

static void test_too_many_rows_are_refused(void **state)
{
	(void)state;
	cau_reference_uniaxial row;
	int32_t count = 0;
	cau_error error = {0};
	assert_int_equal(
		cau_reference_uniaxial_read(CAU_TEST_REFERENCE "/uniaxial.txt", 1, &row, &count, &error),
		CAU_LIMIT);
	assert_int_equal(
		cau_reference_uniaxial_read(CAU_TEST_REFERENCE "/none.txt", 1, &row, &count, &error),
		CAU_IO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_rows_are_the_closed_form),
		cmocka_unit_test(test_too_many_rows_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

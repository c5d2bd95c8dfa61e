// SPDX-License-Identifier: GPL-3.0-or-later
// The entries of the table of laws: properties on which the solver relies.
#include "constraint/elements.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static void every_row_is_a_law(void **state)
{
	(void)state;
	for (int model = 0; model < CAU_MODEL_COUNT; model++) {
		const cau_law *law = cau_law_of(model);
		// a ratio of 0.5 would be incompressible
		assert_true(law->poisson_most > 0 && law->poisson_most < 0.5);
		// if mu and lambda are positive, so are the evaluated parameters
		assert_true(law->mu_mu > 0 && law->lambda_mu >= 0);
		assert_true(law->meaning[0] != 0);
		for (int other = 0; other < model; other++)
			assert_string_not_equal(law->word, cau_law_of(other)->word);
	}
	assert_false(cau_law_of(CAU_MODEL_ENERGY)->has_energy); // the printed constraint has no energy
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_row_is_a_law),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

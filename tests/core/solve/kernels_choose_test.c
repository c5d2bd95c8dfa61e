// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rig/rig.h"

static int rank_of(const char *tier)
{
	static const char *const tiers[] = {"baseline", "avx2", "avx512"};
	for (int k = 0; k < 3; k++)
		if (!strcmp(tier, tiers[k]))
			return k;
	fail_msg("no tier is called %s", tier);
	return -1;
}

static void test_the_best_below_the_ceiling(void **state)
{
	(void)state;
	static const char *const ceilings[] = {"baseline", "avx2", "avx512", NULL, ""};
	for (int single = 0; single < 2; single++) {
		int last = 0;
		for (int k = 0; k < 5; k++) {
			const cau_kernels *kernels = cau_kernels_choose(single, ceilings[k]);
			int rank = rank_of(kernels->instruction_set);
			assert_int_equal(kernels->single, single);
			assert_true(rank >= last); // a higher ceiling never gives a lower tier
			assert_true(k > 2 || rank <= k);
			last = rank;
		}
		assert_int_equal(rank_of(cau_kernels_choose(single, NULL)->instruction_set), last);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(test_the_best_below_the_ceiling)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

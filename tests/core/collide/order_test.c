// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that cau_collide_sort orders pairs by their parts, whatever order blocks found them in.
#include "collide/collide.h"

#include "core/rig/rig.h"

static uint32_t draw(uint64_t *random)
{
	*random = *random * 6364136223846793005ull + 1442695040888963407ull;
	return (uint32_t)(*random >> 33);
}

static bool is_before(const cau_collide_found *a, const cau_collide_found *b)
{
	return a->first != b->first ? a->first < b->first : a->second < b->second;
}

// Sorts random pairs and expects their order. With few different first parts, several pairs have
// the same first part. The other members of a pair must move with the pair.
static void expect_order(int32_t count, int32_t firsts, int32_t seconds, uint64_t *random)
{
	static cau_collide_found found[CAU_COLLIDE_SLICE];
	double sum = 0;
	for (int32_t i = 0; i < count; i++) {
		int32_t first = (int32_t)(draw(random) % (uint32_t)firsts);
		int32_t second = (int32_t)(draw(random) % (uint32_t)seconds);
		found[i] = (cau_collide_found){first, second, first + 0.5 * second, i};
		sum += i;
	}
	cau_collide_sort(found, count);
	for (int32_t i = 0; i < count; i++) {
		assert_true(i == 0 || !is_before(&found[i], &found[i - 1]));
		assert_true(found[i].thickness_m == found[i].first + 0.5 * found[i].second);
		sum -= found[i].stiffness;
	}
	assert_true(sum == 0); // sum of whole numbers: no pair is lost and none is there twice
}

static void found_is_in_order_of_parts(void **state)
{
	(void)state;
	static const int32_t count[] = {0, 1, 2, 7, 63, 64, 65, 300, CAU_COLLIDE_SLICE};
	uint64_t random = 3;
	for (size_t i = 0; i < sizeof count / sizeof *count; i++) {
		expect_order(count[i], 1, 200000, &random);
		expect_order(count[i], 40, 3, &random);
		expect_order(count[i], 500, 70000, &random);
		expect_order(count[i], INT32_MAX, INT32_MAX, &random);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(found_is_in_order_of_parts)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

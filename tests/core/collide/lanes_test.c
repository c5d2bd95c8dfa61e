// SPDX-License-Identifier: GPL-3.0-or-later
// Tests groups of boxes against each box alone in double precision.
#include "collide/lanes.h"

#include "core/rig/rig.h"

enum { CASES = 20000 };
static const double THICKNESS_M = 5e-4;
// Largest error of `least` and `most`, which are rounded to float, for positions within a metre.
static const double ROUNDING_M = 2e-7;

static double draw(uint64_t *random)
{
	*random = *random * 6364136223846793005ull + 1442695040888963407ull;
	return (double)(*random >> 11) / 9007199254740992.0 - 0.5;
}

typedef struct box {
	double least[3], most[3];
} box;

// Returns a random box, at most a decimetre wide, at a position within a few decimetres.
static box draw_box(uint64_t *random)
{
	box b;
	for (int c = 0; c < 3; c++) {
		b.least[c] = 0.2 * draw(random);
		b.most[c] = b.least[c] + 0.1 * (draw(random) + 0.5);
	}
	return b;
}

static bool are_near(const box *a, const box *b, double by_m)
{
	bool near = true;
	for (int c = 0; c < 3; c++)
		near &= a->least[c] - by_m <= b->most[c] && b->least[c] - by_m <= a->most[c];
	return near;
}

static cau_collide_asking ask(const box *b)
{
	cau_collide_lanes alone;
	cau_lanes_put(&alone, 3, b->least, b->most, THICKNESS_M);
	return cau_lanes_ask(&alone, 3);
}

static void expect_like_double(const box *asked, const box *boxes, int count)
{
	cau_collide_lanes group;
	for (int k = 0; k < count; k++)
		cau_lanes_put(&group, k, boxes[k].least, boxes[k].most, THICKNESS_M);
	cau_lanes_close(&group, count);
	cau_collide_asking asking = ask(asked);
	uint32_t met = cau_lanes_meet(&group, &asking);
	assert_int_equal(met >> count, 0);
	for (int k = 0; k < count; k++) {
		bool meets = met >> k & 1;
		assert_true(meets || !are_near(asked, &boxes[k], THICKNESS_M));
		assert_true(!meets || are_near(asked, &boxes[k], THICKNESS_M + ROUNDING_M));
	}
}

static void groups_meet_what_boxes_meet(void **state)
{
	(void)state;
	uint64_t random = 11;
	for (int i = 0; i < CASES; i++) {
		box asked = draw_box(&random), boxes[CAU_LANES];
		for (int k = 0; k < CAU_LANES; k++)
			boxes[k] = draw_box(&random);
		expect_like_double(&asked, boxes, i % (CAU_LANES + 1));
	}
}

// Boxes that just touch in double precision are found. This is tested along each axis and from both
// sides.
static void what_just_touches_is_met(void **state)
{
	(void)state;
	uint64_t random = 12;
	for (int i = 0; i < CASES; i++) {
		box asked = draw_box(&random), other = asked;
		int c = i % 3;
		double wide = other.most[c] - other.least[c];
		if (i & 1) {
			other.most[c] = asked.least[c] - THICKNESS_M;
			other.least[c] = other.most[c] - wide;
		} else {
			other.least[c] = asked.most[c] + THICKNESS_M;
			while (other.least[c] - THICKNESS_M > asked.most[c])
				other.least[c] = nextafter(other.least[c], -INFINITY);
			other.most[c] = other.least[c] + wide;
		}
		assert_true(are_near(&asked, &other, THICKNESS_M));
		expect_like_double(&asked, &other, 1);
	}
}

static void what_is_nowhere_meets_nothing(void **state)
{
	(void)state;
	box nowhere = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
	box everywhere = {{-1e300, -1e300, -1e300}, {1e300, 1e300, 1e300}};
	box boxes[] = {nowhere, everywhere};
	cau_collide_lanes group;
	for (int k = 0; k < 2; k++)
		cau_lanes_put(&group, k, boxes[k].least, boxes[k].most, THICKNESS_M);
	cau_lanes_close(&group, 2);
	box some = {{0, 0, 0}, {1, 1, 1}};
	cau_collide_asking asking = ask(&some), of_nowhere = ask(&nowhere);
	assert_int_equal(cau_lanes_meet(&group, &asking), 2);
	assert_int_equal(cau_lanes_meet(&group, &of_nowhere) & 1, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(groups_meet_what_boxes_meet),
		cmocka_unit_test(what_just_touches_is_met),
		cmocka_unit_test(what_is_nowhere_meets_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

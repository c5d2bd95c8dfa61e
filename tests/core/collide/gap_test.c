// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the distances of random parts against the least distance over a fine grid of their points.
#include "collide/gap.h"

#include "core/rig/rig.h"

enum { CASES = 300, GRID = 60 };
static const double ROUNDING = 1e-12;
// Largest error of the grid's least distance, for parts of size 1.
static const double GRID_STEP = 2.0 / GRID;

static double draw(uint64_t *random)
{
	*random = *random * 6364136223846793005ull + 1442695040888963407ull;
	return (double)(*random >> 11) / 9007199254740992.0 - 0.5;
}

static cau_vec3 between(const cau_vec3 *corner, double a, double b)
{
	return cau_add(cau_scale(1 - a - b, corner[0]),
	               cau_add(cau_scale(a, corner[1]), cau_scale(b, corner[2])));
}

static double least_on_grid(cau_gap_kind kind, const cau_vec3 corner[4])
{
	double least = INFINITY;
	for (int i = 0; i <= GRID; i++)
		for (int j = 0; j <= GRID; j++) {
			double a = (double)i / GRID, b = (double)j / GRID;
			cau_vec3 p = corner[0], q;
			if (kind == CAU_GAP_EDGE_EDGE) {
				p = cau_add(cau_scale(1 - a, corner[0]), cau_scale(a, corner[1]));
				q = cau_add(cau_scale(1 - b, corner[2]), cau_scale(b, corner[3]));
			} else {
				q = between(corner + 1, a * (1 - b), b);
			}
			least = fmin(least, cau_length(cau_sub(p, q)));
		}
	return least;
}

static void expect_least(cau_gap_kind kind, const cau_vec3 corner[4])
{
	cau_gap gap = cau_gap_between(kind, corner);
	double grid = least_on_grid(kind, corner), sum = 0;
	cau_vec3 way = {0, 0, 0};
	for (int i = 0; i < 4; i++) {
		sum += gap.weight[i];
		way = cau_add_scaled(way, gap.weight[i], corner[i]);
	}
	assert_true(fabs(sum) < ROUNDING);
	assert_true(cau_gap_distance(kind, corner) == gap.distance); // equal to the bit
	assert_true(gap.distance <= grid + ROUNDING && gap.distance >= grid - GRID_STEP);
	assert_true(cau_length(cau_add_scaled(way, -gap.distance, gap.normal)) < ROUNDING);
	assert_true(cau_gap_along(kind, corner, gap.normal) >= gap.distance - ROUNDING);
}

static void random_parts(void **state)
{
	(void)state;
	uint64_t random = 7;
	for (int k = 0; k < CASES; k++) {
		cau_vec3 corner[4];
		for (int i = 0; i < 4; i++)
			corner[i] = (cau_vec3){draw(&random), draw(&random), draw(&random)};
		if (k % 3 == 0) // parallel edges, and a vertex in the plane of the face, outside it
			corner[3] = cau_add(corner[2], cau_sub(corner[1], corner[0]));
		expect_least(CAU_GAP_VERTEX_FACE, corner);
		expect_least(CAU_GAP_EDGE_EDGE, corner);
		cau_vec3 any = cau_unit_or(cau_sub(corner[0], corner[3]), (cau_vec3){1, 0, 0});
		for (int kind = 0; kind < 2; kind++)
			assert_true(cau_gap_along((cau_gap_kind)kind, corner, any) <=
			            cau_gap_between((cau_gap_kind)kind, corner).distance + ROUNDING);
	}
}

static void parts_without_extent(void **state)
{
	(void)state;
	const cau_vec3 o = {0, 0, 0}, p = {3, 4, 0};
	for (int kind = 0; kind < 2; kind++) {
		cau_vec3 corner[4] = {o, kind ? o : p, p, p};
		assert_true(fabs(cau_gap_between((cau_gap_kind)kind, corner).distance - 5) < ROUNDING);
		cau_gap none = cau_gap_between((cau_gap_kind)kind, (cau_vec3[]){o, o, o, o});
		assert_true(none.distance == 0 && cau_length(none.normal) == 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(random_parts),
		cmocka_unit_test(parts_without_extent),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The distance between a tool and a triangle, against sampling and known results.
#include "tool/tool_shape.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/tool/tools.h"

enum { TRIES = 400, SAMPLES = 60 };

// Largest errors of the least distance. Along a long tool the search may end before it converges,
// after 24 steps.
// relative to the distance, for triangles outside the tool
static const double OUTSIDE_SHARE = 0.02;
// relative to the radius, for triangles that reach inside the tool
static const double INSIDE_SHARE = 0.2;

static cau_vec3 weighted(const cau_vec3 corner[3], const double weight[3])
{
	cau_vec3 sum = cau_scale(weight[0], corner[0]);
	return cau_add_scaled(cau_add_scaled(sum, weight[1], corner[1]), weight[2], corner[2]);
}

static void assert_weights(const double weight[3])
{
	for (int k = 0; k < 3; k++)
		assert_true(weight[k] >= -1e-12);
	assert_true(fabs(weight[0] + weight[1] + weight[2] - 1) < 1e-12);
}

static void random_triangle(uint64_t *random, double size, cau_vec3 corner[3])
{
	for (int k = 0; k < 3; k++)
		corner[k] = random_point(random, size);
}

// Returns the least value of f over samples of a triangle.
static double sampled(const cau_vec3 corner[3], double (*f)(cau_vec3 point, const void *of),
                      const void *of)
{
	double least = INFINITY;
	for (int i = 0; i <= SAMPLES; i++)
		for (int j = 0; i + j <= SAMPLES; j++) {
			const double weight[3] = {(double)(SAMPLES - i - j) / SAMPLES, (double)i / SAMPLES,
			                          (double)j / SAMPLES};
			least = fmin(least, f(weighted(corner, weight), of));
		}
	return least;
}

static double from_point(cau_vec3 point, const void *of)
{
	return cau_length(cau_sub(point, *(const cau_vec3 *)of));
}

static double from_tool(cau_vec3 point, const void *of)
{
	return cau_tool_distance(of, 0, CAU_PART_HOT, point, NULL);
}

static void the_nearest_point_is_nearest(void **state)
{
	(void)state;
	uint64_t random = 7;
	for (int k = 0; k < TRIES; k++) {
		cau_vec3 corner[3], point = random_point(&random, 1);
		double weight[3];
		random_triangle(&random, 1, corner);
		cau_nearest_on_triangle(point, corner, weight);
		assert_weights(weight);
		double found = cau_length(cau_sub(weighted(corner, weight), point));
		double least = sampled(corner, from_point, &point);
		assert_true(found <= least + 1e-12);
		assert_true(found >= least - 4.0 / SAMPLES);
	}
}

// Round tools are convex, so the search downhill finds the global minimum.
static void the_least_distance_of_round_tools_is_least(void **state)
{
	(void)state;
	static const int shapes[] = {CAU_TOOL_SPHERE, CAU_TOOL_CAPSULE};
	uint64_t random = 11;
	for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
		cau_tool_def tool = tool_with_defaults(shapes[s]);
		for (int k = 0; k < TRIES; k++) {
			cau_vec3 corner[3], gradient;
			double weight[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};
			random_triangle(&random, 4 * tool.hot_radius_m, corner);
			double found =
				cau_tool_face_distance(&tool, 0, CAU_PART_HOT, corner, weight, &gradient);
			assert_weights(weight);
			assert_true(fabs(found - from_tool(weighted(corner, weight), &tool)) < 1e-12);
			assert_true(fabs(cau_length(gradient) - 1) < 1e-9);
			double over = found - sampled(corner, from_tool, &tool);
			assert_true(over <=
			            (found > 0 ? OUTSIDE_SHARE * found : INSIDE_SHARE * tool.hot_radius_m));
		}
	}
}

static void the_way_out_is_the_last_surface(void **state)
{
	(void)state;
	cau_tool_def ball = tool_with_defaults(CAU_TOOL_SPHERE);
	const cau_vec3 down = {0, 0, -1}, middle = {0, 0, 0};
	double radius = ball.hot_radius_m;
	cau_vec3 gradient;
	double way = cau_tool_way_out(&ball, 0, CAU_PART_HOT, middle, down, 3 * radius, &gradient);
	assert_true(fabs(way - radius) < 1e-6);
	assert_true(cau_dot(gradient, down) > 0.99);
	// from a point beyond the ball, the whole ball is in the way
	cau_vec3 beyond = {0, 0, 2 * radius};
	way = cau_tool_way_out(&ball, 0, CAU_PART_HOT, beyond, down, 5 * radius, &gradient);
	assert_true(fabs(way - 3 * radius) < 1e-6);
	// beside the ball and before it, nothing is in the way
	cau_vec3 beside = {1.1 * radius, 0, radius}, before = {0, 0, -1.1 * radius};
	assert_true(cau_tool_way_out(&ball, 0, CAU_PART_HOT, beside, down, 3 * radius, &gradient) == 0);
	assert_true(cau_tool_way_out(&ball, 0, CAU_PART_HOT, before, down, 3 * radius, &gradient) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_nearest_point_is_nearest),
		cmocka_unit_test(the_least_distance_of_round_tools_is_least),
		cmocka_unit_test(the_way_out_is_the_last_surface),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

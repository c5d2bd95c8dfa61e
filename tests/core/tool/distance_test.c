// SPDX-License-Identifier: GPL-3.0-or-later
// The solids that tools consist of: known distances, and the arc against a dense sampling of its
// core.
#include "tool/distance.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/tool/tools.h"

// Largest error: rounding of a few operations on lengths near 1.
static const double ROUNDING = 1e-14;

static void test_capsule(void **state)
{
	(void)state;
	cau_vec3 g, a = {0, 0, 0}, b = {0, 0, 2};
	assert_near(cau_distance_capsule((cau_vec3){3, 0, 1}, a, b, 0.5, &g), 2.5, ROUNDING);
	assert_near(g.x, 1, ROUNDING);
	assert_near(cau_distance_capsule((cau_vec3){0, 3, 6}, a, b, 0.5, &g), 4.5, ROUNDING);
	assert_near(g.y, 0.6, ROUNDING);
	assert_near(g.z, 0.8, ROUNDING);
	assert_near(cau_distance_capsule((cau_vec3){0, 0, 1}, a, b, 0.5, &g), -0.5, ROUNDING);
	assert_near(cau_length(g), 1, ROUNDING);
	assert_near(g.z, 0, ROUNDING); // on the core, any direction perpendicular to it is allowed
	assert_near(cau_distance_capsule(a, a, a, 0.5, &g), -0.5, ROUNDING);
	assert_near(cau_length(g), 1, ROUNDING);
}

static void test_rounded_box(void **state)
{
	(void)state;
	cau_vec3 g, center = {1, 1, 1}, half = {1, 2, 0};
	double d = cau_distance_rounded_box((cau_vec3){1, 1, 4}, center, half, 0.5, &g);
	assert_near(d, 2.5, ROUNDING);
	assert_near(g.z, 1, ROUNDING);
	d = cau_distance_rounded_box((cau_vec3){1 - 1 - 3, 1 + 2 + 4, 1}, center, half, 0.5, &g);
	assert_near(d, 4.5, ROUNDING);
	assert_near(g.x, -0.6, ROUNDING);
	assert_near(g.y, 0.8, ROUNDING);
	half.z = 3; // inside the core the nearest face counts
	d = cau_distance_rounded_box((cau_vec3){0.25, 1, 1}, center, half, 0.5, &g);
	assert_near(d, -0.75, ROUNDING);
	assert_near(g.x, -1, ROUNDING);
}

static void test_quarter_arc_against_sampling(void **state)
{
	(void)state;
	enum { SAMPLES = 2000, POINTS = 300 };
	const double radius = 1.5, tube = 0.25;
	// Half the spacing of samples: the nearest sample of the curve is at most this far from the
	// nearest point.
	const double sampling = radius * (M_PI / 2) / SAMPLES / 2;
	cau_vec3 center = {0.3, -0.2, 0.5};
	uint64_t random = 11;
	for (int i = 0; i < POINTS; i++) {
		cau_vec3 p = random_point(&random, 3);
		double nearest = INFINITY;
		for (int k = 0; k <= SAMPLES; k++) {
			double angle = M_PI + (M_PI / 2) * k / SAMPLES;
			cau_vec3 core = {center.x + radius * cos(angle), center.y,
			                 center.z + radius * sin(angle)};
			nearest = fmin(nearest, cau_length(cau_sub(p, core)) - tube);
		}
		double d = cau_distance_quarter_arc(p, center, radius, tube, NULL);
		assert_true(d <= nearest + ROUNDING);
		assert_true(d >= nearest - sampling);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_capsule),
		cmocka_unit_test(test_rounded_box),
		cmocka_unit_test(test_quarter_arc_against_sampling),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

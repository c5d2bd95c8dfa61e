// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the exposure of edges near a tool at rest, cases in which it must be zero, and the parts of
// a swept tick.
#include "heat/exposure.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/tool/tools.h"

static const double AMBIENT_C = 37;
static const double TICK_S = 1.0 / 60;
// Ends of an edge that is wholly inside the hot ball, so all nodes around the edge are held.
static const cau_vec3 A = {-4e-4, 2e-4, 1e-4}, B = {5e-4, -3e-4, 2e-4};

static cau_heat_grid create(const cau_tool_def *tool)
{
	cau_heat_grid grid;
	assert_int_equal(cau_heat_grid_create(&grid, tool, AMBIENT_C, TICK_S, &tool->pose, NULL),
	                 CAU_OK);
	return grid;
}

// Returns the time (s) until the exposure of A-B exceeds `delta_c`, with an energized ball of 3 mm
// on a 1 mm grid.
static double time_to_part(double temperature_c, double absorption_per_s, double delta_c)
{
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	tool.temperature_c = temperature_c;
	cau_heat_grid grid = create(&tool);
	double exposure = 0;
	int ticks = 0;
	for (; exposure <= delta_c && ticks < 600; ticks++) {
		cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
		exposure += cau_exposure_gain(&grid, &tool, &tool.pose, 0, A, B, absorption_per_s, TICK_S);
	}
	cau_heat_grid_finish(&grid);
	return ticks * TICK_S;
}

static void test_time_to_part(void **state)
{
	(void)state;
	// delta / (xi u); the tolerance is a tick, because exposure is checked once per tick
	assert_near(time_to_part(170, 0.4, 160), 160 / (0.4 * 170), TICK_S); // fascia, 2.35 s
	assert_near(time_to_part(90, 0.6, 78), 78 / (0.6 * 90), TICK_S);     // fat, 1.44 s
}

static void test_no_exposure_below_living(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	static const double temperatures[] = {AMBIENT_C, 37, 44.9};
	for (int i = 0; i < 3; i++) {
		tool.temperature_c = temperatures[i];
		cau_heat_grid grid = create(&tool);
		cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, i > 0, TICK_S);
		assert_true(cau_exposure_gain(&grid, &tool, &tool.pose, 0, A, B, 0.4, 1e6) == 0);
		cau_heat_grid_finish(&grid);
	}
	tool.temperature_c = 45.1;
	cau_heat_grid grid = create(&tool);
	cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
	assert_true(cau_exposure_gain(&grid, &tool, &tool.pose, 0, A, B, 0.4, TICK_S) > 0);
	cau_heat_grid_finish(&grid);
}

// Warm nodes alone do not char an edge. The edge must meet the hot shape.
static void test_no_exposure_outside_the_shape(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	cau_heat_grid grid = create(&tool);
	for (int i = 0; i < 60; i++)
		cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
	cau_vec3 near = {3.1e-3, -1e-3, 0}, by = {3.1e-3, 1e-3, 0};
	double mean = (cau_heat_grid_at(&grid, near) + cau_heat_grid_at(&grid, by)) / 2;
	assert_true(mean > 100);
	assert_true(cau_exposure_gain(&grid, &tool, &tool.pose, 0, near, by, 0.4, TICK_S) == 0);
	// Both ends are outside the ball, and the edge passes through it.
	cau_vec3 across = {-3.1e-3, 1e-3, 0};
	assert_true(cau_exposure_gain(&grid, &tool, &tool.pose, 0, near, across, 0.4, TICK_S) > 0);
	cau_pose lifted = pose_at(0, 0, 5e-3); // the tool has left, and its heat is still there
	assert_true(cau_exposure_gain(&grid, &tool, &tool.pose, 0, A, B, 0.4, TICK_S) > 0);
	assert_true(cau_exposure_gain(&grid, &tool, &lifted, 0, A, B, 0.4, TICK_S) == 0);
	cau_heat_grid_finish(&grid);
}

// Returns the greatest distance that any point of the hot part moves between two poses.
static double greatest_way(const cau_tool_def *tool, const cau_pose *from, const cau_pose *to)
{
	uint64_t random = 41;
	double greatest = 0;
	for (int i = 0; i < 4000; i++) {
		cau_vec3 p = random_point(&random, 0.015);
		if (cau_tool_distance(tool, 0, CAU_PART_HOT, p, NULL) > 0)
			continue;
		cau_vec3 way = cau_sub(cau_pose_to_world(to, p), cau_pose_to_world(from, p));
		greatest = fmax(greatest, cau_length(way));
	}
	return greatest;
}

static void test_parts(void **state)
{
	(void)state;
	for (int shape = 0; shape < CAU_TOOL_GRASPER; shape++) {
		cau_tool_def tool = tool_with_defaults(shape);
		double half = cau_tool_thinnest_hot_m(&tool) / 2;
		cau_pose from = pose_at(0.1, 0.2, 0.3), same = from;
		assert_int_equal(cau_exposure_parts(&tool, &from, &same), 1);
		cau_pose on = pose_at(0.1 + 2.5 * half, 0.2, 0.3);
		assert_int_equal(cau_exposure_parts(&tool, &from, &on), 3);
		cau_pose far = pose_at(1.1, 0.2, 0.3);
		assert_int_equal(cau_exposure_parts(&tool, &from, &far), 32);
		cau_pose turned = pose_turned((cau_vec3){0.101, 0.2, 0.299}, (cau_vec3){1, 1, 0}, 0.5);
		int parts = cau_exposure_parts(&tool, &from, &turned);
		assert_true(parts > 1 && parts < 32);
		for (int k = 0; k < parts; k++) {
			cau_pose start = cau_pose_between(&from, &turned, (double)k / parts);
			cau_pose end = cau_pose_between(&from, &turned, (k + 1.0) / parts);
			assert_true(greatest_way(&tool, &start, &end) <= half);
		}
	}
	cau_tool_def grasper = tool_with_defaults(CAU_TOOL_GRASPER);
	cau_pose from = pose_at(0, 0, 0), to = pose_at(1, 0, 0);
	assert_int_equal(cau_exposure_parts(&grasper, &from, &to), 1);
}

// The number of parts follows from half a cell, up to four. It is never less than the number for
// the swept shape.
static void test_heating_parts(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	double cell = tool.grid_step_m;
	static const double cells[] = {0, 0.5, 0.51, 1.4, 2, 3};
	static const int parts[] = {1, 1, 2, 3, 4, 4};
	cau_pose from = pose_at(0.1, 0.2, 0.3);
	for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
		cau_pose to = pose_at(0.1 + cells[k] * cell, 0.2, 0.3);
		assert_int_equal(cau_heating_parts(&tool, &from, &to), parts[k]);
		assert_true(cau_exposure_parts(&tool, &from, &to) <= parts[k]);
	}
	cau_pose far = pose_at(1.1, 0.2, 0.3);
	assert_int_equal(cau_heating_parts(&tool, &from, &far), 32);
	cau_tool_def grasper = tool_with_defaults(CAU_TOOL_GRASPER);
	assert_int_equal(cau_heating_parts(&grasper, &from, &far), 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_time_to_part),
		cmocka_unit_test(test_no_exposure_below_living),
		cmocka_unit_test(test_no_exposure_outside_the_shape),
		cmocka_unit_test(test_parts),
		cmocka_unit_test(test_heating_parts),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

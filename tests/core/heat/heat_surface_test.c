// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the field around a hot part whose surface is between the nodes: against the solution around
// a ball, and against finer grids for a moving ball.
#include "heat/heat_field.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/tool/tools.h"
#include "heat/exposure.h"

static const double AMBIENT_C = 37;
static const double TICK_S = 1.0 / 60;
static const double RADIUS_M = 3e-3;
// Largest error that is accepted, as a share of the tool's excess over ambient: 2 %, with cells of
// a sixth of the radius.
static const double ASKED = 0.02;

static cau_tool_def ball_of(double step_m, int cells)
{
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	tool.hot_radius_m = RADIUS_M;
	tool.grid_step_m = step_m;
	tool.grid_cells = cells;
	tool.pose = pose_at(0.23e-3, -0.41e-3, 0.37e-3); // the middle is on no node
	return tool;
}

static cau_heat_grid create(const cau_tool_def *tool)
{
	cau_heat_grid grid;
	assert_int_equal(cau_heat_grid_create(&grid, tool, AMBIENT_C, TICK_S, &tool->pose, NULL),
	                 CAU_OK);
	return grid;
}

// Returns the field outside a ball that is held at 1 from time 0 on, in an infinite medium at 0
// (Carslaw and Jaeger).
static double around_ball(double r, double time_s, double diffusivity)
{
	return RADIUS_M / r * erfc((r - RADIUS_M) / (2 * sqrt(diffusivity * time_s)));
}

static cau_vec3 direction(uint64_t *random)
{
	for (;;) {
		cau_vec3 d = {random_between(random, -1, 1), random_between(random, -1, 1),
		              random_between(random, -1, 1)};
		double length = cau_length(d);
		if (length > 0.1 && length < 1)
			return cau_scale(1 / length, d);
	}
}

// Returns the greatest error from the surface to ten radii, relative to the tool's excess, against
// the solution at `against_s`.
static double worst_around_ball(const cau_tool_def *tool, int parts, double part_s,
                                double against_s)
{
	cau_heat_grid grid = create(tool);
	for (int i = 0; i < parts; i++)
		cau_heat_grid_advance(&grid, tool, &tool->pose, 0, 1, part_s);
	double worst = 0, excess = tool->temperature_c - AMBIENT_C;
	uint64_t random = 19;
	for (int i = 0; i < 4000; i++) {
		// Most of the points are near the surface.
		double r = RADIUS_M * (1 + 9 * pow(random_between(&random, 0, 1), 3));
		cau_vec3 at = cau_add_scaled(cau_vec3_of(tool->pose.position_m), r, direction(&random));
		double u = (cau_heat_grid_at(&grid, at) - AMBIENT_C) / excess;
		worst = fmax(worst, fabs(u - around_ball(r, against_s, tool->diffusivity_m2_s)));
	}
	cau_heat_grid_finish(&grid);
	return worst;
}

static void test_around_a_ball(void **state)
{
	(void)state;
	cau_tool_def tool = ball_of(RADIUS_M / 6, 32);
	static const struct {
		int parts;
		double part_s;
	} run[] = {{60, 1.0 / 60}, {600, 1.0 / 60}, {600, 0.1}, {300, 1}, {600, 1}};
	// sanitizers need one run, because all runs use the same code
	size_t runs = CAU_TEST_SANITIZED ? 1 : sizeof run / sizeof *run;
	for (size_t k = 0; k < runs; k++) {
		double time_s = run[k].parts * run[k].part_s;
		double worst = worst_around_ball(&tool, run[k].parts, run[k].part_s, time_s);
		print_message("ball: %.2f %% after %g s\n", 100 * worst, time_s);
		assert_true(worst < ASKED);
	}
}

// A smaller grid settles sooner. After twenty minutes the field no longer changes.
static void test_steady_around_a_ball(void **state)
{
	(void)state;
	cau_tool_def tool = ball_of(RADIUS_M / 6, 24);
	double worst = worst_around_ball(&tool, 120, 10, INFINITY);
	print_message("ball: %.2f %% when steady\n", 100 * worst);
	assert_true(worst < ASKED);
}

// Cells of half the length, compared with those of a default tool, have less than half of the
// error.
static void test_finer_is_better(void **state)
{
	(void)state;
	static const double DEFAULTS = 0.05;
	cau_tool_def coarse = ball_of(RADIUS_M / 3, 16), fine = ball_of(RADIUS_M / 6, 32);
	double at_a_third = worst_around_ball(&coarse, 240, TICK_S, 4);
	double at_a_sixth = worst_around_ball(&fine, 240, TICK_S, 4);
	print_message("ball: %.2f %% at a third of the radius, %.2f %% at a sixth\n", 100 * at_a_third,
	              100 * at_a_sixth);
	assert_true(at_a_third < DEFAULTS);
	assert_true(at_a_sixth < at_a_third / 2);
}

// In the first half second the warm layer is only a cell or two thick. At 0.1 s cells of a sixth of
// the radius are too coarse, but ticks are short enough. With cells of half the length, the error
// is less than a third. With ticks of an eighth of the length, it is still more than four fifths.
static void test_soon_after_the_beginning(void **state)
{
	(void)state;
	static const double SECOND_ORDER_AT_LEAST = 3;
	cau_tool_def tool = ball_of(RADIUS_M / 6, 32), finer = ball_of(RADIUS_M / 12, 64);
	double at_a_sixth = worst_around_ball(&tool, 6, TICK_S, 0.1);
	double eighths = worst_around_ball(&tool, 48, TICK_S / 8, 0.1);
	double at_a_twelfth = worst_around_ball(&finer, 6, TICK_S, 0.1);
	print_message("ball: %.2f %% after 0.1 s, %.2f %% by eighths of ticks, %.2f %% at a twelfth\n",
	              100 * at_a_sixth, 100 * eighths, 100 * at_a_twelfth);
	assert_true(at_a_twelfth < ASKED);
	assert_true(at_a_sixth > SECOND_ORDER_AT_LEAST * at_a_twelfth);
	assert_true(eighths > 0.8 * at_a_sixth);
}

// ---- a ball that moves

// Returns the field a second after the ball has started to move at `speed_m_s`, obliquely to the
// axes. Each tick has `parts` parts; 0 means as many as sessions use.
static cau_heat_grid after_a_way(cau_tool_def *tool, double speed_m_s, int parts)
{
	cau_heat_grid grid = create(tool);
	const cau_pose start = tool->pose;
	for (int tick = 1; tick <= 60; tick++) {
		cau_pose before = tool->pose, now = start;
		cau_vec3 at = cau_add_scaled(cau_vec3_of(start.position_m), speed_m_s * tick * TICK_S,
		                             (cau_vec3){0.8, 0.36, 0.48});
		cau_vec3_to(at, now.position_m);
		int count = parts ? parts : cau_heating_parts(tool, &before, &now);
		for (int part = 1; part <= count; part++) {
			tool->pose = cau_pose_between(&before, &now, (double)part / count);
			cau_heat_grid_advance(&grid, tool, &tool->pose, 0, 1, TICK_S / count);
		}
	}
	return grid;
}

// Returns the root mean square of the differences of two fields, relative to the excess. The points
// are between the surface and 3 mm from it or, if `cube`, in the cube of 14 mm around the ball.
static double difference(const cau_tool_def *tool, const cau_heat_grid *a, const cau_heat_grid *b,
                         bool cube)
{
	double sum = 0;
	uint64_t random = 23;
	enum { POINTS = 4000 };
	for (int i = 0; i < POINTS; i++) {
		double r = random_between(&random, RADIUS_M, 2 * RADIUS_M);
		cau_vec3 off = cau_scale(r, direction(&random));
		if (cube)
			off = (cau_vec3){random_between(&random, -7e-3, 7e-3),
			                 random_between(&random, -7e-3, 7e-3),
			                 random_between(&random, -7e-3, 7e-3)};
		cau_vec3 at = cau_add(cau_vec3_of(tool->pose.position_m), off);
		double d = cau_heat_grid_at(a, at) - cau_heat_grid_at(b, at);
		sum += d * d;
	}
	return sqrt(sum / POINTS) / (tool->temperature_c - AMBIENT_C);
}

// 50 mm/s is faster than any cut. At this speed the warm layer is thinner than a cell of a sixth of
// the radius, so the accuracy is required only over the cube. The reference has cells of half the
// length and eighths of the ticks.
static void test_a_moving_ball(void **state)
{
	(void)state;
	static const double speeds_m_s[] = {5e-3, 10e-3, 20e-3, 50e-3};
	const size_t speeds = sizeof speeds_m_s / sizeof *speeds_m_s;
	for (size_t k = 0; k < speeds; k++) {
		cau_tool_def tool = ball_of(RADIUS_M / 6, 32), finer = ball_of(RADIUS_M / 12, 64);
		cau_heat_grid reference = after_a_way(&finer, speeds_m_s[k], 8);
		cau_heat_grid grid = after_a_way(&tool, speeds_m_s[k], 0);
		double near = difference(&tool, &grid, &reference, false);
		double cube = difference(&tool, &grid, &reference, true);
		print_message("moving ball: %.2f %% rms near, %.2f %% over the cube at %g mm/s\n",
		              100 * near, 100 * cube, 1e3 * speeds_m_s[k]);
		assert_true(cube < ASKED);
		assert_true(near < ASKED || speeds_m_s[k] > 20e-3);
		cau_heat_grid_finish(&grid);
		cau_heat_grid_finish(&reference);
	}
}

// With steps of exactly dl^2 / (6 alpha), and the surface anywhere between the nodes or on them,
// all values stay between ambient and the tool's temperature. Held points are at the tool's
// temperature.
static void test_stable_wherever_the_surface_is(void **state)
{
	(void)state;
	static const float ROUNDING_C = 1e-3F; // largest error, K: rounding of floats near 200
	cau_tool_def tool = ball_of(1e-3, 16);
	double limit = 1e-6 / (6 * tool.diffusivity_m2_s);
	uint64_t random = 29;
	for (int trial = 0; trial < 60; trial++) {
		double cell = trial < 20 ? 1e-3 * trial / 20 : 0;
		cau_vec3 off = {random_between(&random, 0, 1e-3), random_between(&random, 0, 1e-3), cell};
		tool.pose = trial < 40 ? pose_at(off.x, trial < 20 ? 0 : off.y, off.z)
		                       : pose_at(1e-7 * (trial - 50), 0, 0);
		cau_heat_grid grid = create(&tool);
		cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, 20 * limit);
		for (int64_t i = 0; i < 16 * 16 * 16; i++) {
			float u = grid.field[0].temperature[i];
			assert_true(u >= (float)AMBIENT_C - ROUNDING_C);
			assert_true(u <= (float)tool.temperature_c + ROUNDING_C);
		}
		cau_vec3 middle = cau_vec3_of(tool.pose.position_m);
		assert_true(cau_heat_grid_at(&grid, middle) == (float)tool.temperature_c);
		cau_heat_grid_finish(&grid);
	}
}

// At the surface the field has the tool's temperature. Linear interpolation between the nodes would
// have an error of a quarter of the fall in a cell. Inside the surface the temperature is exact to
// the bit from the first tick on, while outer nodes are still cold.
static void test_read_up_to_the_surface(void **state)
{
	(void)state;
	cau_tool_def tool = ball_of(RADIUS_M / 6, 32);
	cau_heat_grid grid = create(&tool);
	double excess = tool.temperature_c - AMBIENT_C;
	uint64_t random = 31;
	for (int tick = 1; tick <= 60; tick++) {
		cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
		for (int i = 0; i < 2000 && (tick == 1 || tick == 60); i++) {
			cau_vec3 d = direction(&random), middle = cau_vec3_of(tool.pose.position_m);
			double at = cau_heat_grid_at(&grid, cau_add_scaled(middle, RADIUS_M, d));
			if (tick == 60)
				assert_near(at, tool.temperature_c, ASKED * excess);
			double within = cau_heat_grid_at(&grid, cau_add_scaled(middle, 0.98 * RADIUS_M, d));
			assert_true(within == tool.temperature_c);
		}
	}
	cau_heat_grid_finish(&grid);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_around_a_ball),
		cmocka_unit_test(test_stable_wherever_the_surface_is),
		cmocka_unit_test(test_read_up_to_the_surface),
	};
	// These tests run the same code for longer, so they are left out with sanitizers. Moving fields
	// are tested with sanitizers in heat_field_test.c and heat_grid_test.c.
	const struct CMUnitTest figures[] = {
		cmocka_unit_test(test_steady_around_a_ball),
		cmocka_unit_test(test_finer_is_better),
		cmocka_unit_test(test_soon_after_the_beginning),
		cmocka_unit_test(test_a_moving_ball),
	};
	int failed = CAU_TEST_SANITIZED ? 0 : cmocka_run_group_tests(figures, NULL, NULL);
	return failed + cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the heat grid: against solutions of the heat equation, at its stability limit, its held
// nodes, and its motion with the tool.
#include "heat/heat_grid.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/tool/tools.h"

static const double AMBIENT_C = 37;
static const double TICK_S = 1.0 / 60;
static const cau_vec3 TIP = {0, 0, 0};

static cau_heat_grid create(const cau_tool_def *tool, const cau_pose *pose)
{
	cau_heat_grid grid;
	cau_error error = {0};
	assert_int_equal(cau_heat_grid_create(&grid, tool, AMBIENT_C, TICK_S, pose, &error), CAU_OK);
	return grid;
}

// Completes the grid after the innermost field was written, as after a restored snapshot of that
// field.
static void go_on_from(cau_heat_grid *grid, const cau_tool_def *tool)
{
	cau_heat_grid_fill_outer(grid);
	cau_heat_grid_take_over(grid, tool, &tool->pose, 0, 0);
}

static int64_t node_count(const cau_heat_grid *grid)
{
	return (int64_t)grid->nodes * grid->nodes * grid->nodes;
}

// Returns the world position of node `index`.
static cau_vec3 node_position(const cau_heat_grid *grid, int64_t index)
{
	int64_t n = grid->nodes;
	return (cau_vec3){(double)(grid->field[0].origin[0] + index % n) * grid->field[0].step_m,
	                  (double)(grid->field[0].origin[1] + index / n % n) * grid->field[0].step_m,
	                  (double)(grid->field[0].origin[2] + index / (n * n)) * grid->field[0].step_m};
}

// Time, s, at which a point source of heat has spread to 100 degC at the centre. At this time its
// standard deviation is 2.9 steps of 1 mm. The boundary is 4.7 standard deviations away.
static const double SPREAD_S = 1.0;
static double gaussian(const cau_heat_grid *grid, cau_vec3 p, double time)
{
	return 100 * pow(SPREAD_S / time, 1.5) * exp(-cau_dot(p, p) / (4 * grid->diffusivity * time));
}

// Returns the greatest error, relative to the solution's peak, after the Gaussian has spread. The
// time is 8 parts of exactly dl^2 / (6 alpha) at 1 mm and 32 such parts at 0.5 mm, so dt is scaled
// with dl^2.
static double gaussian_error(double step_m, int nodes)
{
	static const double DURATION_S = 8 * 1e-6 / (6 * 4.2e-6);
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	tool.grid_step_m = step_m;
	tool.grid_cells = nodes;
	cau_heat_grid grid = create(&tool, &tool.pose);
	for (int64_t i = 0; i < node_count(&grid); i++) {
		double hot = gaussian(&grid, node_position(&grid, i), SPREAD_S);
		grid.field[0].temperature[i] = (float)(AMBIENT_C + hot);
	}
	go_on_from(&grid, &tool);
	cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 0, DURATION_S);
	double worst = 0;
	for (int64_t i = 0; i < node_count(&grid); i++) {
		double exact = gaussian(&grid, node_position(&grid, i), SPREAD_S + DURATION_S);
		worst = fmax(worst, fabs(grid.field[0].temperature[i] - AMBIENT_C - exact));
	}
	worst /= gaussian(&grid, TIP, SPREAD_S + DURATION_S);
	cau_heat_grid_finish(&grid);
	return worst;
}

static void test_gaussian(void **state)
{
	(void)state;
	static const double ONE_PERCENT = 0.01;
	// SECOND_ORDER: ratio of the errors if the error falls with dl^2. HIGHER_TERMS: largest
	// difference from this ratio, by terms of order dl^4 at 1 mm.
	static const double SECOND_ORDER = 4, HIGHER_TERMS = 0.3;
	double coarse = gaussian_error(1e-3, 32);
	double fine = gaussian_error(0.5e-3, 64);
	print_message("gaussian: %.3g at 1 mm, %.3g at 0.5 mm, ratio %.3f\n", coarse, fine,
	              coarse / fine);
	assert_true(coarse < ONE_PERCENT);
	assert_near(coarse / fine, SECOND_ORDER, HIGHER_TERMS);
}

static void test_substeps(void **state)
{
	(void)state;
	const double limit = 1e-6 / (6 * 4.2e-6); // longest stable substep, s, at 1 mm: 39.7 ms
	assert_int_equal(cau_heat_grid_substeps(1e-3, 4.2e-6, limit), 1);
	assert_int_equal(cau_heat_grid_substeps(1e-3, 4.2e-6, limit * 1.001), 2);
	assert_int_equal(cau_heat_grid_substeps(1e-3, 4.2e-6, limit * 7), 7);
	assert_int_equal(cau_heat_grid_substeps(0.25e-3, 4.2e-6, TICK_S), 7); // 2.5 ms each
	assert_int_equal(cau_heat_grid_substeps(1e-3, 0, 1000), 1);
}

// At exactly the limit every new value is a mean of the six values around it. So noise stays within
// its extremes and decays. A step 5 % above the limit would make the finest noise grow by a factor
// of 1.1 in each part.
static void test_stable_at_the_limit(void **state)
{
	(void)state;
	// largest error, K: rounding of float means near 100, over 64 parts
	static const double ROUNDING_C = 1e-4;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	cau_heat_grid grid = create(&tool, &tool.pose);
	uint64_t random = 21;
	double most = 0;
	// the field is a checkerboard, the least stable field
	for (int64_t i = 0; i < node_count(&grid); i++) {
		int64_t n = grid.nodes, x = i % n, y = i / n % n, z = i / (n * n);
		if (x * y * z == 0 || x == n - 1 || y == n - 1 || z == n - 1)
			continue; // boundary nodes stay at ambient
		int odd = (x + y + z) & 1;
		grid.field[0].temperature[i] =
			(float)(AMBIENT_C + (odd ? 60 : -60) + random_between(&random, -1, 1));
	}
	go_on_from(&grid, &tool);
	double start = grid.warmest_c - AMBIENT_C;
	for (int i = 0; i < 10; i++) {
		cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 0,
		                      64 * grid.field[0].step_m * grid.field[0].step_m /
		                          (6 * grid.diffusivity));
		double now = fmax(grid.warmest_c - AMBIENT_C, AMBIENT_C - grid.coldest_c);
		assert_true(now <= (i ? most : start) + ROUNDING_C);
		most = now;
	}
	assert_true(most < start / 2);
	cau_heat_grid_finish(&grid);
}

static void expect_refusal(const cau_tool_def *tool, double tick_s, const char *path)
{
	cau_heat_grid grid;
	cau_error error = {0};
	assert_int_equal(cau_heat_grid_create(&grid, tool, AMBIENT_C, tick_s, &tool->pose, &error),
	                 CAU_BAD_VALUE);
	assert_string_equal(error.path, path);
	assert_true(error.reason[0] != 0);
}

static void test_refusals(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	double limit = tool.grid_step_m * tool.grid_step_m / (6 * tool.diffusivity_m2_s);
	cau_heat_grid grid;
	assert_int_equal(cau_heat_grid_create(&grid, &tool, AMBIENT_C, 64 * limit, &tool.pose, NULL),
	                 CAU_OK);
	cau_heat_grid_finish(&grid);
	expect_refusal(&tool, 64.001 * limit, "grid_step_m");
	// with this step the hot part would fit between the nodes
	tool.grid_step_m = tool.hot_radius_m * 1.001;
	expect_refusal(&tool, TICK_S, "grid_step_m");
	// the spatula's blade is thinner than the tool's hot radius, so the step is too large
	tool = tool_with_defaults(CAU_TOOL_SPATULA);
	tool.grid_step_m = tool.hot_radius_m / 2;
	expect_refusal(&tool, TICK_S, "grid_step_m");
	tool.grid_step_m = NAN;
	expect_refusal(&tool, TICK_S, "grid_step_m");
	tool = tool_with_defaults(CAU_TOOL_SPHERE);
	tool.grid_cells = 2;
	expect_refusal(&tool, TICK_S, "grid_cells");
	tool.grid_cells = 16;
	tool.diffusivity_m2_s = NAN;
	expect_refusal(&tool, TICK_S, "diffusivity_m2_s");
}

// Exactly the nodes inside the hot part are held: for every shape, rotated, at any jaw angle. All
// other values are between ambient and the tool's temperature. Away from the surface they are
// strictly below the tool's temperature.
static void test_hot_nodes_hold(void **state)
{
	(void)state;
	// Cells: distance from the surface up to which a node's value may round to the tool's
	// temperature.
	static const double AT_THE_SURFACE = 0.05;
	for (int shape = 0; shape < CAU_TOOL_GRASPER; shape++) {
		cau_tool_def tool = tool_with_defaults(shape);
		tool.pose = pose_turned((cau_vec3){0.0123, -0.0234, 0.0011}, (cau_vec3){1, -2, 0.5}, 0.7);
		cau_heat_grid grid = create(&tool, &tool.pose);
		for (int i = 0; i < 5; i++)
			cau_heat_grid_advance(&grid, &tool, &tool.pose, 0.5, 1, TICK_S);
		int held = 0;
		for (int64_t i = 0; i < node_count(&grid); i++) {
			cau_vec3 p = node_position(&grid, i);
			double d = cau_tool_distance_at(&tool, &tool.pose, 0.5, CAU_PART_HOT, p, NULL) /
			           grid.field[0].step_m;
			float u = grid.field[0].temperature[i];
			if (d < -1e-9)
				assert_true(u == (float)tool.temperature_c);
			else if (d > AT_THE_SURFACE)
				assert_true(u >= (float)AMBIENT_C && u < (float)tool.temperature_c);
			held += d < 0;
		}
		assert_true(held > 10); // the hot part is on the grid
		assert_near(cau_heat_grid_warmest(&grid), tool.temperature_c, 1e-4);
		cau_heat_grid_finish(&grid);
	}
}

// Nodes that stay keep their values to the bit. New nodes are at ambient, because the wider field
// is at ambient there. Outer nodes take the values of the wider field.
static void test_shift_keeps_values(void **state)
{
	(void)state;
	static const int64_t shifts[][3] = {
		{3, 0, 0}, {-2, 1, 0}, {0, -5, 4}, {-1, -1, -1}, {13, 0, 0}};
	for (size_t k = 0; k < sizeof shifts / sizeof *shifts; k++) {
		cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
		tool.diffusivity_m2_s = 0; // nothing but the shift changes a value
		cau_heat_grid grid = create(&tool, &tool.pose);
		const int64_t *shift = shifts[k];
		int64_t n = grid.nodes, total = node_count(&grid);
		float before[16 * 16 * 16];
		assert_int_equal(n, 16);
		for (int64_t i = 0; i < total; i++)
			before[i] = grid.field[0].temperature[i] = 40 + (float)i / 64;
		go_on_from(&grid, &tool);
		double step = grid.field[0].step_m;
		cau_pose there =
			pose_at((double)shift[0] * step, (double)shift[1] * step, (double)shift[2] * step);
		cau_heat_grid_advance(&grid, &tool, &there, 0, 0, TICK_S);
		int kept = 0;
		for (int64_t i = 0; i < total; i++) {
			int64_t x = i % n, y = i / n % n, z = i / (n * n);
			int64_t ox = x + shift[0], oy = y + shift[1], oz = z + shift[2];
			int outer = x * y * z == 0 || x == n - 1 || y == n - 1 || z == n - 1;
			int had = ox >= 0 && ox < n && oy >= 0 && oy < n && oz >= 0 && oz < n;
			if (outer)
				continue;
			float expected = had ? before[(oz * n + oy) * n + ox] : (float)AMBIENT_C;
			assert_true(grid.field[0].temperature[i] == expected);
			kept += had;
		}
		assert_true(kept > 0);
		cau_heat_grid_finish(&grid);
	}
}

// Motions of less than a cell do not move the grid. Nor does a rotation about the tip of a sphere.
static void test_follows_in_whole_cells(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	cau_pose pose = pose_at(0.0002, 0.0002, 0.0002);
	cau_heat_grid grid = create(&tool, &pose);
	int64_t before[3];
	memcpy(before, grid.field[0].origin, sizeof before);
	pose = pose_turned((cau_vec3){0.0008, 0.0008, 0.0008}, (cau_vec3){0, 1, 0}, 1);
	cau_heat_grid_advance(&grid, &tool, &pose, 0, 1, TICK_S);
	assert_memory_equal(before, grid.field[0].origin, sizeof before);
	pose = pose_at(0.0108, 0.0008, -0.0012);
	cau_heat_grid_advance(&grid, &tool, &pose, 0, 1, TICK_S);
	assert_int_equal(grid.field[0].origin[0] - before[0], 10);
	assert_int_equal(grid.field[0].origin[1] - before[1], 0);
	assert_int_equal(grid.field[0].origin[2] - before[2], -2);
	cau_heat_grid_finish(&grid);
}

// Heat that a tool leaves behind is stored in the outer fields. One case keeps the tool in place
// for a second after heating. In the other case the tool moves 20 mm away, beyond the innermost
// field. The tissue is about as warm in both cases.
static void test_heat_that_is_left_behind_stays(void **state)
{
	(void)state;
	// largest relative difference: cells of 4 mm resolve a spot of 8 mm no better
	static const double COARSER = 0.1;
	double left_c[2];
	for (int goes = 0; goes < 2; goes++) {
		cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
		cau_heat_grid grid = create(&tool, &tool.pose);
		for (int i = 0; i < 300; i++)
			cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
		for (int i = 1; i <= 60; i++) {
			cau_pose pose = pose_at(goes * 20e-3 * i / 60, 0, 0);
			cau_heat_grid_advance(&grid, &tool, &pose, 0, 0, TICK_S);
		}
		left_c[goes] = cau_heat_grid_at(&grid, TIP) - AMBIENT_C;
		cau_heat_grid_finish(&grid);
	}
	print_message("left behind: %.1f degC above ambient, %.1f under the tool\n", left_c[1],
	              left_c[0]);
	assert_true(left_c[0] > 20);
	assert_near(left_c[1], left_c[0], COARSER * left_c[0]);
}

static void test_leap_leaves_the_heat_behind(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	cau_heat_grid grid = create(&tool, &tool.pose);
	cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
	assert_near(cau_heat_grid_warmest(&grid), tool.temperature_c, 1e-4);
	cau_pose far = pose_at(1, -1, 1e20);
	cau_heat_grid_advance(&grid, &tool, &far, 0, 0, TICK_S);
	assert_true(cau_heat_grid_warmest(&grid) == AMBIENT_C);
	for (int64_t i = 0; i < node_count(&grid); i++)
		assert_true(grid.field[0].temperature[i] == (float)AMBIENT_C);
	cau_heat_grid_finish(&grid);
}

// With energy off, the field cools and comes to rest at ambient. From then on no node is changed.
static void test_comes_to_rest(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	cau_heat_grid grid = create(&tool, &tool.pose);
	for (int i = 0; i < 60; i++)
		cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
	double previous = cau_heat_grid_warmest(&grid);
	int ticks = 0;
	for (; cau_heat_grid_warmest(&grid) > AMBIENT_C; ticks++) {
		cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 0, TICK_S);
		assert_true(cau_heat_grid_warmest(&grid) <= previous);
		previous = cau_heat_grid_warmest(&grid);
		// The slowest mode decays in 1.8 s. The field is at rest after ln(133 / 0.01) such times.
		assert_true(ticks < 60 * 30);
	}
	assert_true(ticks > 60);
	float *field = grid.field[0].temperature;
	grid.field[0].next[0] = 99; // this value would reach the field with the next exchange
	cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 0, TICK_S);
	assert_ptr_equal(field, grid.field[0].temperature);
	assert_true(grid.field[0].temperature[0] == (float)AMBIENT_C);
	cau_heat_grid_finish(&grid);
}

// A pose that is not a number holds no node and heats nothing, neither now nor after the tool is
// back.
static void test_survives_a_bad_pose(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_HOOK);
	cau_heat_grid grid = create(&tool, &tool.pose);
	cau_pose nowhere = pose_at(NAN, 0, INFINITY);
	cau_heat_grid_advance(&grid, &tool, &nowhere, NAN, 1, TICK_S);
	assert_true(cau_heat_grid_warmest(&grid) == AMBIENT_C);
	cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
	assert_near(cau_heat_grid_at(&grid, TIP), tool.temperature_c, 1e-4);
	cau_heat_grid_finish(&grid);
}

static void test_interpolation(void **state)
{
	(void)state;
	static const double ROUNDING_C = 1e-4; // largest error, K: rounding of floats near 100
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	cau_pose pose = pose_at(0.5, -0.25, 0.125);
	cau_heat_grid grid = create(&tool, &pose);
	// a linear field, which interpolation reproduces exactly
	for (int64_t i = 0; i < node_count(&grid); i++) {
		cau_vec3 p = node_position(&grid, i);
		grid.field[0].temperature[i] =
			(float)(60 + 1e3 * (p.x - 0.5) + 2e3 * (p.y + 0.25) - 3e3 * (p.z - 0.125));
	}
	go_on_from(&grid, &tool);
	uint64_t random = 31;
	for (int i = 0; i < 500; i++) {
		cau_vec3 p = {0.5 + random_between(&random, -7e-3, 7e-3),
		              -0.25 + random_between(&random, -7e-3, 7e-3),
		              0.125 + random_between(&random, -7e-3, 7e-3)};
		double exact = 60 + 1e3 * (p.x - 0.5) + 2e3 * (p.y + 0.25) - 3e3 * (p.z - 0.125);
		assert_near(cau_heat_grid_at(&grid, p), exact, ROUNDING_C);
	}
	assert_true(cau_heat_grid_at(&grid, (cau_vec3){0.52, -0.25, 0.125}) == AMBIENT_C);
	assert_true(cau_heat_grid_at(&grid, (cau_vec3){NAN, -0.25, 0.125}) == AMBIENT_C);
	cau_heat_grid_finish(&grid);
}

// A tool colder than the body cools the field. A shape without a hot part never heats.
static void test_cold_tools(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	tool.temperature_c = 5;
	cau_heat_grid grid = create(&tool, &tool.pose);
	for (int i = 0; i < 10; i++)
		cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
	assert_near(cau_heat_grid_at(&grid, TIP), 5, 1e-4);
	assert_near(cau_heat_grid_warmest(&grid), AMBIENT_C, 1e-4);
	cau_heat_grid_finish(&grid);
	tool = tool_with_defaults(CAU_TOOL_GRASPER);
	grid = create(&tool, &tool.pose);
	cau_heat_grid_advance(&grid, &tool, &tool.pose, 0, 1, TICK_S);
	assert_true(cau_heat_grid_warmest(&grid) == AMBIENT_C);
	cau_heat_grid_finish(&grid);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_gaussian),
		cmocka_unit_test(test_substeps),
		cmocka_unit_test(test_stable_at_the_limit),
		cmocka_unit_test(test_refusals),
		cmocka_unit_test(test_hot_nodes_hold),
		cmocka_unit_test(test_shift_keeps_values),
		cmocka_unit_test(test_follows_in_whole_cells),
		cmocka_unit_test(test_heat_that_is_left_behind_stays),
		cmocka_unit_test(test_leap_leaves_the_heat_behind),
		cmocka_unit_test(test_comes_to_rest),
		cmocka_unit_test(test_survives_a_bad_pose),
		cmocka_unit_test(test_interpolation),
		cmocka_unit_test(test_cold_tools),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The temperature channel against the heat grids: the tool's temperature inside the hot part, the
// grid's interpolation around it, ambient outside the grid.
#include <string.h>

#include "core/rig/rig.h"
#include "dissect/near.h"
#include "frame/frame_state.h"

static const double AMBIENT_C = 37;
static const double TICK_S = 1.0 / 60;
// Largest error of a temperature, degC: rounding of sums of eight floats near 200 degC.
static const double FLOAT_C = 1e-4;

typedef struct heated {
	rig r;
	cau_frame_state frame;
	cau_near near;
} heated;

static void make(heated *h)
{
	memset(h, 0, sizeof *h);
	rig_begin(&h->r);
	rig_add_sheet(&h->r, 100, 80); // vertices are 1 mm apart
	rig_build(&h->r, NULL, 1);
	assert_int_equal(cau_frame_create(&h->frame, &h->r.tissue, &h->r.dissection, &h->r.arena, NULL),
	                 CAU_OK);
	assert_int_equal(cau_near_create(&h->near, &h->r.tissue, &h->r.arena, NULL), CAU_OK);
	cau_near_refit(&h->near, h->r.solver.position);
	cau_frame_cool(&h->frame, &h->r.tissue, AMBIENT_C);
}

static cau_tool_def sphere_at(double x, double y)
{
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	tool.pose = pose_at(x, y, 0);
	return tool;
}

static cau_heat_grid grid_of(const cau_tool_def *tool)
{
	cau_heat_grid grid;
	assert_int_equal(cau_heat_grid_create(&grid, tool, AMBIENT_C, TICK_S, &tool->pose, NULL),
	                 CAU_OK);
	return grid;
}

static cau_heat_grid burning(const cau_tool_def *tool, int ticks)
{
	cau_heat_grid grid = grid_of(tool);
	for (int tick = 0; tick < ticks; tick++)
		cau_heat_grid_advance(&grid, tool, &tool->pose, 0, 1, TICK_S);
	return grid;
}

static cau_vec3 place_of(const heated *h, int32_t vertex)
{
	return cau_vec3_of(h->r.solver.position + 3 * (size_t)vertex);
}

static void heat(heated *h, const cau_heat_grid *grid)
{
	cau_frame_heat(&h->frame, &h->near, grid, h->r.solver.position);
}

static void test_hot_inside_ambient_beyond(void **state)
{
	(void)state;
	heated h;
	make(&h);
	cau_tool_def tool = sphere_at(0.0002, -0.0003);
	tool.grid_cells = 8; // a small grid, so that some vertices are outside
	cau_heat_grid grid = burning(&tool, 60);
	heat(&h, &grid);
	cau_vec3 least, most;
	cau_heat_grid_box(&grid, &least, &most);
	// Tolerance for vertices on the box.
	const double corner = sqrt(3) * grid.field[0].step_m, on_m = 1e-9;
	int inside = 0, between = 0, beyond = 0;
	for (int32_t v = 0; v < h.r.tissue.vertex_count; v++) {
		cau_vec3 at = place_of(&h, v);
		double distance = cau_length(cau_sub(at, cau_vec3_of(tool.pose.position_m)));
		double now = (double)h.frame.temperature[v];
		// All nodes around the vertex are inside the hot part.
		if (distance < tool.hot_radius_m - corner) {
			assert_near(now, tool.temperature_c, FLOAT_C);
			inside++;
		} else if (at.x < least.x - on_m || at.y < least.y - on_m || at.x > most.x + on_m ||
		           at.y > most.y + on_m) {
			assert_true(now == AMBIENT_C);
			beyond++;
		} else {
			between += now > AMBIENT_C + 1 && now < tool.temperature_c - 1;
		}
	}
	assert_true(inside > 3 && between > 50 && beyond > 1000);
	cau_heat_grid_finish(&grid);
	rig_finish(&h.r);
}

// Trilinear interpolation reproduces a field that is linear in space.
static void test_a_linear_field_is_read_as_it_is(void **state)
{
	(void)state;
	heated h;
	make(&h);
	cau_tool_def tool = sphere_at(0.01, 0.02);
	cau_heat_grid grid = grid_of(&tool);
	const double base = 100, slope[3] = {2000, -3000, 1500}; // degC, degC/m
	int64_t n = grid.nodes;
	for (int64_t i = 0; i < n * n * n; i++) {
		const int64_t node[3] = {i % n, i / n % n, i / (n * n)};
		double value = base;
		for (int axis = 0; axis < 3; axis++)
			value += slope[axis] * (double)(grid.field[0].origin[axis] + node[axis]) *
			         grid.field[0].step_m;
		grid.field[0].temperature[i] = (float)value;
	}
	cau_heat_grid_take_over(&grid, &tool, &tool.pose, 0, 0);
	uint64_t random = 5;
	double turned[3][3];
	mat_rotation((double[]){1, 0.3, 0}, 0.2, turned); // rotated out of the plane of the nodes
	rig_deform(&h.r, turned, 2e-4, &random, h.r.solver.position);
	cau_near_refit(&h.near, h.r.solver.position);
	heat(&h, &grid);
	int inside = 0;
	for (int32_t v = 0; v < h.r.tissue.vertex_count; v++) {
		double at[3], expected = base;
		cau_vec3_to(place_of(&h, v), at);
		int in = 1;
		for (int axis = 0; axis < 3; axis++) {
			double nodes = at[axis] / grid.field[0].step_m - (double)grid.field[0].origin[axis];
			in &= nodes >= 0 && nodes <= (double)(n - 1);
			expected += slope[axis] * at[axis];
		}
		assert_near((double)h.frame.temperature[v], in ? expected : AMBIENT_C, FLOAT_C);
		inside += in;
	}
	assert_true(inside > 100);
	assert_int_equal(h.frame.heated_count, inside);
	cau_heat_grid_finish(&grid);
	rig_finish(&h.r);
}

// Where two grids overlap, the value farther from ambient is taken, in any order of the tools.
// Tools may also cool.
static void test_the_hotter_of_two_tools_stands(void **state)
{
	(void)state;
	heated h;
	make(&h);
	cau_tool_def tools[3] = {sphere_at(-0.004, 0), sphere_at(0.004, 0.001), sphere_at(0.03, 0.02)};
	tools[1].temperature_c = 400;
	tools[2].temperature_c = 5;
	cau_heat_grid grids[3];
	for (int i = 0; i < 3; i++)
		grids[i] = burning(&tools[i], 40);
	float *first = cau_arena_array(&h.r.arena, (size_t)h.r.tissue.vertex_count, sizeof *first);
	for (int order = 0; order < 2; order++) {
		cau_frame_cool_heated(&h.frame);
		for (int i = 0; i < 3; i++)
			heat(&h, &grids[order ? 2 - i : i]);
		if (!order)
			memcpy(first, h.frame.temperature, (size_t)h.r.tissue.vertex_count * sizeof *first);
	}
	int shared = 0, cold = 0;
	for (int32_t v = 0; v < h.r.tissue.vertex_count; v++) {
		double a = cau_heat_grid_at(&grids[0], place_of(&h, v));
		double b = cau_heat_grid_at(&grids[1], place_of(&h, v));
		double c = cau_heat_grid_at(&grids[2], place_of(&h, v));
		double hotter = fmax(a, b), away = fmax(AMBIENT_C - c, hotter - AMBIENT_C);
		double expected = AMBIENT_C - c > hotter - AMBIENT_C ? c : hotter;
		if (away > FLOAT_C) { // of two values equally far from ambient, either may be taken
			assert_true(h.frame.temperature[v] == (float)expected);
			assert_true(h.frame.temperature[v] == first[v]);
		}
		shared += a > AMBIENT_C && b > AMBIENT_C;
		cold += c < AMBIENT_C;
	}
	assert_true(shared > 20 && cold > 20);
	for (int i = 0; i < 3; i++)
		cau_heat_grid_finish(&grids[i]);
	rig_finish(&h.r);
}

// Vertices that the grid has left are at ambient again. All vertices are at ambient once the tool
// has cooled.
static void test_left_vertices_are_at_ambient(void **state)
{
	(void)state;
	heated h;
	make(&h);
	cau_tool_def tool = sphere_at(-0.03, 0);
	cau_heat_grid grid = burning(&tool, 10);
	for (int tick = 0; tick < 30; tick++) {
		cau_pose pose = pose_at(-0.03 + 0.002 * tick, 0.001 * tick, 0);
		cau_heat_grid_advance(&grid, &tool, &pose, 0, 1, TICK_S);
		cau_frame_cool_heated(&h.frame);
		heat(&h, &grid);
		int32_t away = 0;
		for (int32_t v = 0; v < h.r.tissue.vertex_count; v++) {
			assert_true(h.frame.temperature[v] == (float)cau_heat_grid_at(&grid, place_of(&h, v)));
			away += h.frame.temperature[v] != (float)AMBIENT_C;
		}
		assert_true(away > 50);
		assert_int_equal(h.frame.heated_count, away);
	}
	cau_pose far = pose_at(1, 1, 1);
	cau_heat_grid_advance(&grid, &tool, &far, 0, 0, TICK_S);
	cau_frame_cool_heated(&h.frame);
	heat(&h, &grid);
	assert_int_equal(h.frame.heated_count, 0);
	for (int32_t v = 0; v < h.r.tissue.vertex_count; v++)
		assert_true(h.frame.temperature[v] == (float)AMBIENT_C);
	cau_heat_grid_finish(&grid);
	rig_finish(&h.r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_hot_inside_ambient_beyond),
		cmocka_unit_test(test_a_linear_field_is_read_as_it_is),
		cmocka_unit_test(test_the_hotter_of_two_tools_stands),
		cmocka_unit_test(test_left_vertices_are_at_ambient),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

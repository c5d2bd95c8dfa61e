// SPDX-License-Identifier: GPL-3.0-or-later
#include "heat/heat_grid.h"

#include <string.h>

#include "cautery/assert.h"
#include "heat/heat_field.h"

static const double REST_C = 0.01; // largest distance from ambient, K, of a node of a field at rest

// Largest distance from ambient, K, of the heat that is dropped from the outer fields. Such heat
// parts no tissue (tissue lives at 41 degC). If no surface is held, the field only falls, so this
// heat parts no tissue later either. The outer fields would take minutes to reach ambient. The
// innermost field alone takes seconds.
static const double FAINT_C = 4;

static int64_t node_count(const cau_heat_grid *grid)
{
	CAU_ASSERT(grid->nodes >= 0 && grid->nodes <= 4096, "%d nodes along a side", grid->nodes);
	return (int64_t)grid->nodes * grid->nodes * grid->nodes;
}

static void rest_from(cau_heat_grid *grid, int innermost)
{
	for (int k = innermost; k < CAU_HEAT_FIELDS; k++)
		cau_heat_field_fill(&grid->field[k], grid->nodes, (float)grid->ambient_c);
	grid->outer_rests = true;
}

static void rest(cau_heat_grid *grid)
{
	rest_from(grid, 0);
	grid->coldest_c = grid->warmest_c = (float)grid->ambient_c;
}

bool cau_heat_grid_is_ambient(const cau_heat_grid *grid)
{
	return grid->coldest_c == grid->warmest_c;
}

int64_t cau_heat_grid_substeps(double step_m, double diffusivity_m2_s, double duration_s)
{
	CAU_ASSERT(step_m > 0 && diffusivity_m2_s >= 0, "a grid of %g m with %g m^2/s", step_m,
	           diffusivity_m2_s);
	double parts = 6 * diffusivity_m2_s * duration_s / (step_m * step_m);
	// the factor keeps a value that is exactly at the limit within the limit, despite rounding
	parts = ceil(parts * (1 - 1e-12));
	return (int64_t)fmin(fmax(parts, 1), 1e9);
}

// Rounds down to whole cells. Limits the result, so that any position fits into an integer.
static int64_t whole_cells(double cells)
{
	return (int64_t)floor(fmin(fmax(cells, -1e15), 1e15));
}

// Computes the origin, node (0,0,0), for which the grid is centred on the hot part.
static void origin_for(const cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                       int64_t origin[3])
{
	cau_vec3 center;
	double radius;
	cau_tool_bound(tool, CAU_PART_HOT, &center, &radius);
	double world[3];
	cau_vec3_to(cau_pose_to_world(pose, center), world);
	for (int axis = 0; axis < 3; axis++)
		origin[axis] =
			whole_cells(world[axis] / grid->field[0].step_m - (grid->nodes - 1) / 2.0 + 0.5);
}

cau_status cau_heat_grid_check(const cau_tool_def *tool, double tick_s, cau_error *error)
{
	double step = tool->grid_step_m;
	double thinnest = cau_tool_thinnest_hot_m(tool);
	if (!(tool->grid_cells >= 3 && tool->grid_cells <= 1024))
		return cau_fail(error, CAU_BAD_VALUE, "grid_cells", "%g is not in 3 to 1024",
		                tool->grid_cells);
	if (!(step > 0 && step <= thinnest * (1 + 1e-12)))
		return cau_fail(error, CAU_BAD_VALUE, "grid_step_m",
		                "%g m is not above 0 and at most the smallest radius of the hot part, %g m",
		                step, thinnest);
	if (!(tool->diffusivity_m2_s >= 0 && tool->diffusivity_m2_s < INFINITY))
		return cau_fail(error, CAU_BAD_VALUE, "diffusivity_m2_s", "%g m^2/s is not a diffusivity",
		                tool->diffusivity_m2_s);
	int64_t substeps = cau_heat_grid_substeps(step, tool->diffusivity_m2_s, tick_s);
	if (substeps > CAU_HEAT_SUBSTEPS_MAX)
		return cau_fail(error, CAU_BAD_VALUE, "grid_step_m",
		                "%g m with %g m^2/s needs %lld substeps of a tick of %g s, more than %d",
		                step, tool->diffusivity_m2_s, (long long)substeps, tick_s,
		                CAU_HEAT_SUBSTEPS_MAX);
	return CAU_OK;
}

// Arrays of a grid: each field and its scratch, and three arrays of the surface.
enum { ARRAYS = 2 * CAU_HEAT_FIELDS + 3 };

static void lay_out(cau_heat_grid *grid, double step_m, size_t nodes)
{
	float *room = grid->pages.start;
	for (int k = 0; k < CAU_HEAT_FIELDS; k++) {
		grid->field[k] = (cau_heat_field){
			.step_m = step_m * (1 << k), .temperature = room, .next = room + nodes};
		room += 2 * nodes;
	}
	grid->surface.distance = room;
	grid->surface.rate = room + nodes;
	grid->surface.pull = room + 2 * nodes;
	grid->fall = room + 3 * nodes;
}

// Sets the outer fields' origins around that of the innermost field.
static void place_outer(cau_heat_grid *grid)
{
	for (int k = 1; k < CAU_HEAT_FIELDS; k++)
		cau_heat_field_origin_around(grid->field[k - 1].origin, grid->nodes, grid->field[k].origin);
}

cau_status cau_heat_grid_create(cau_heat_grid *grid, const cau_tool_def *tool, double ambient_c,
                                double tick_s, const cau_pose *pose, cau_error *error)
{
	*grid = (cau_heat_grid){0};
	cau_status status = cau_heat_grid_check(tool, tick_s, error);
	if (status != CAU_OK)
		return status;
	grid->nodes = (int32_t)tool->grid_cells;
	grid->diffusivity = tool->diffusivity_m2_s;
	grid->ambient_c = ambient_c;
	size_t nodes = (size_t)node_count(grid), face = (size_t)grid->nodes * (size_t)grid->nodes;
	size_t floats = ARRAYS * nodes + face;
	if (!cau_pages_take(&grid->pages, floats * sizeof(float)))
		return cau_fail(error, CAU_NO_MEMORY, "grid_cells", "no memory for %d^3 nodes",
		                (int)tool->grid_cells);
	lay_out(grid, tool->grid_step_m, nodes);
	cau_heat_field_fall(grid->nodes, grid->fall);
	origin_for(grid, tool, pose, grid->field[0].origin);
	place_outer(grid);
	rest(grid);
	return CAU_OK;
}

void cau_heat_grid_finish(cau_heat_grid *grid)
{
	cau_pages_give_back(&grid->pages);
	*grid = (cau_heat_grid){0};
}

// Copies the inner fields to the nodes of the outer fields at the same positions.
static void take_inner(cau_heat_grid *grid)
{
	for (int k = 1; k < CAU_HEAT_FIELDS; k++)
		cau_heat_field_take_inner(&grid->field[k], grid->nodes, &grid->field[k - 1]);
}

static bool is_leap(const cau_heat_field *field, int32_t nodes, const int64_t origin[3])
{
	for (int axis = 0; axis < 3; axis++) {
		int64_t shift = origin[axis] - field->origin[axis];
		if (shift <= -nodes || shift >= nodes)
			return true;
	}
	return false;
}

// Moves the fields so that they are centred on the hot part, the outermost first. The inner fields
// take values of new nodes from the outer fields. No value is resampled: nodes that stay keep their
// values.
static void follow(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose)
{
	int64_t origin[CAU_HEAT_FIELDS][3] = {0};
	int32_t n = grid->nodes;
	origin_for(grid, tool, pose, origin[0]);
	if (!memcmp(origin[0], grid->field[0].origin, sizeof origin[0]))
		return;
	for (int k = 1; k < CAU_HEAT_FIELDS; k++)
		cau_heat_field_origin_around(origin[k - 1], n, origin[k]);
	const int last = CAU_HEAT_FIELDS - 1;
	if (cau_heat_grid_is_ambient(grid) || is_leap(&grid->field[last], n, origin[last])) {
		if (!cau_heat_grid_is_ambient(grid))
			rest(grid);
		for (int k = 0; k <= last; k++)
			memcpy(grid->field[k].origin, origin[k], sizeof origin[k]);
		return;
	}
	if (!grid->outer_rests)
		take_inner(grid);
	for (int k = last; k >= 0; k--)
		cau_heat_field_move(&grid->field[k], n, origin[k], k < last ? &grid->field[k + 1] : NULL);
}

// ---- advancing

static double rate_of(const cau_heat_grid *grid, int k, double duration_s, int64_t *substeps)
{
	double step = grid->field[k].step_m;
	*substeps = cau_heat_grid_substeps(step, grid->diffusivity, duration_s);
	double rate = grid->diffusivity * (duration_s / (double)*substeps) / (step * step);
	CAU_ASSERT(rate >= 0 && rate <= (1 + 1e-9) / 6, "a rate of %g is not stable", rate);
	return rate;
}

// Advances the outer fields, the outermost first. Each field takes its boundary from the next wider
// field. Before each substep, nodes inside the next finer field get that field's values.
static void advance_outer(cau_heat_grid *grid, double duration_s)
{
	int32_t n = grid->nodes;
	for (int k = CAU_HEAT_FIELDS - 1; k > 0; k--) {
		cau_heat_field *field = &grid->field[k];
		bool outermost = k == CAU_HEAT_FIELDS - 1;
		int64_t substeps;
		double rate = rate_of(grid, k, duration_s, &substeps);
		if (!outermost)
			cau_heat_field_take_boundary(field, n, field + 1);
		for (int64_t i = 0; i < substeps; i++) {
			cau_heat_field_take_inner(field, n, field - 1);
			cau_diffuse(field->temperature, (float)rate, field->next, n);
			cau_heat_field_swap(field);
			if (outermost)
				cau_heat_field_open_boundary(field, n, (float)grid->ambient_c, grid->fall);
		}
	}
}

static void advance_innermost(cau_heat_grid *grid, double duration_s)
{
	cau_heat_field *field = &grid->field[0];
	cau_heat_surface *surface = &grid->surface;
	int64_t substeps;
	double rate = rate_of(grid, 0, duration_s, &substeps);
	cau_heat_field_take_boundary(field, grid->nodes, field + 1);
	if (surface->held)
		cau_heat_surface_hold(surface, field, grid->nodes, rate);
	for (int64_t i = 0; i < substeps; i++) {
		if (surface->held)
			cau_diffuse_around(field->temperature, surface->rate, surface->pull, surface->held_c,
			                   field->next, grid->nodes);
		else
			cau_diffuse(field->temperature, (float)rate, field->next, grid->nodes);
		cau_heat_field_swap(field);
	}
}

static bool is_within(const cau_heat_grid *grid, double most_c)
{
	return fabs(grid->coldest_c - grid->ambient_c) <= most_c &&
	       fabs(grid->warmest_c - grid->ambient_c) <= most_c;
}

static void survey(cau_heat_grid *grid)
{
	int64_t count = node_count(grid);
	CAU_ASSERT(grid->nodes >= 3, "a survey of %d nodes", grid->nodes);
	cau_extremes(grid->field[0].temperature, count, &grid->coldest_c, &grid->warmest_c);
	if (grid->surface.held && !is_within(grid, REST_C))
		return;
	for (int k = 1; k < CAU_HEAT_FIELDS && !grid->outer_rests; k++) {
		float least, most;
		cau_extremes(grid->field[k].temperature, count, &least, &most);
		grid->coldest_c = least < grid->coldest_c ? least : grid->coldest_c;
		grid->warmest_c = most > grid->warmest_c ? most : grid->warmest_c;
	}
	if (is_within(grid, REST_C))
		rest(grid);
	else if (!grid->surface.held && !grid->outer_rests && is_within(grid, FAINT_C))
		rest_from(grid, 1);
}

void cau_heat_grid_advance(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                           double jaw, bool energized, double duration_s)
{
	CAU_ASSERT(duration_s >= 0, "a part of %g s", duration_s);
	follow(grid, tool, pose);
	grid->surface.held = false;
	bool heating = energized && cau_tool_thinnest_hot_m(tool) < INFINITY;
	if (cau_heat_grid_is_ambient(grid) && !heating)
		return;
	if (heating) {
		grid->outer_rests = false;
		cau_heat_surface_find(&grid->surface, &grid->field[0], grid->nodes, tool, pose, jaw);
	}
	if (!grid->outer_rests)
		advance_outer(grid, duration_s);
	advance_innermost(grid, duration_s);
	survey(grid);
}

void cau_heat_grid_fill_outer(cau_heat_grid *grid)
{
	CAU_ASSERT(grid->nodes >= 3, "%d nodes to fill from", grid->nodes);
	rest_from(grid, 1);
	place_outer(grid);
	take_inner(grid);
}

void cau_heat_grid_take_over(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                             double jaw, bool energized)
{
	place_outer(grid);
	grid->surface.held = energized && cau_tool_thinnest_hot_m(tool) < INFINITY;
	if (grid->surface.held)
		cau_heat_surface_find(&grid->surface, &grid->field[0], grid->nodes, tool, pose, jaw);
	float least, most;
	grid->outer_rests = true;
	for (int k = 1; k < CAU_HEAT_FIELDS; k++) {
		cau_extremes(grid->field[k].temperature, node_count(grid), &least, &most);
		grid->outer_rests &= least == most && least == (float)grid->ambient_c;
	}
	survey(grid);
}

// ---- reading

double cau_heat_grid_at(const cau_heat_grid *grid, cau_vec3 point)
{
	cau_heat_cell cell;
	const cau_heat_field *field = grid->field;
	int fields = grid->outer_rests ? 1 : CAU_HEAT_FIELDS;
	if (cau_heat_field_find(field, grid->nodes, point, &cell))
		return cau_heat_surface_at(&grid->surface, field, grid->nodes, &cell);
	for (int k = 1; k < fields; k++)
		if (cau_heat_field_find(&field[k], grid->nodes, point, &cell))
			return cau_heat_cell_mean(&cell, &field[k], grid->nodes);
	return grid->ambient_c;
}

void cau_heat_grid_box(const cau_heat_grid *grid, cau_vec3 *least, cau_vec3 *most)
{
	const cau_heat_field *field = &grid->field[grid->outer_rests ? 0 : CAU_HEAT_FIELDS - 1];
	double step = field->step_m, side = (grid->nodes - 1) * step;
	*least = (cau_vec3){(double)field->origin[0] * step, (double)field->origin[1] * step,
	                    (double)field->origin[2] * step};
	*most = cau_add(*least, (cau_vec3){side, side, side});
}

double cau_heat_grid_warmest(const cau_heat_grid *grid)
{
	return cau_heat_grid_is_ambient(grid) ? grid->ambient_c : (double)grid->warmest_c;
}

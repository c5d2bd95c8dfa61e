// SPDX-License-Identifier: GPL-3.0-or-later
#include "heat/heat_grid.h"

#include <string.h>

#include "cautery/assert.h"
#include "heat/diffuse.h"

static const double REST_C = 0.01; // a field nowhere further from ambient is at rest

static int64_t node_count(const cau_heat_grid *grid)
{
	CAU_ASSERT(grid->nodes >= 0 && grid->nodes <= 4096, "%d nodes along a side", grid->nodes);
	return (int64_t)grid->nodes * grid->nodes * grid->nodes;
}

static void fill(float *values, int64_t count, float value)
{
	for (int64_t i = 0; i < count; i++)
		values[i] = value;
}

static void rest(cau_heat_grid *grid)
{
	CAU_ASSERT(grid->temperature && grid->next, "a grid of %d nodes without fields", grid->nodes);
	float ambient = (float)grid->ambient_c;
	fill(grid->temperature, node_count(grid), ambient);
	fill(grid->next, node_count(grid), ambient); // its outer nodes are never written again
	grid->coldest_c = grid->warmest_c = ambient;
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
	parts = ceil(parts * (1 - 1e-12)); // exactly at the limit is within it, whatever the rounding
	return (int64_t)fmin(fmax(parts, 1), 1e9);
}

// Whole cells, kept within what an integer holds for any position.
static int64_t whole_cells(double cells)
{
	return (int64_t)floor(fmin(fmax(cells, -1e15), 1e15));
}

// The node (0,0,0) for which the grid is centred on the hot part.
static void origin_for(const cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                       int64_t origin[3])
{
	cau_vec3 center;
	double radius;
	cau_tool_bound(tool, CAU_PART_HOT, &center, &radius);
	double world[3];
	cau_vec3_to(cau_pose_to_world(pose, center), world);
	for (int axis = 0; axis < 3; axis++)
		origin[axis] = whole_cells(world[axis] / grid->step_m - (grid->nodes - 1) / 2.0 + 0.5);
}

static cau_status check(const cau_tool_def *tool, double tick_s, cau_error *error)
{
	double step = tool->grid_step_m;
	double thinnest = cau_tool_thinnest_hot_m(tool);
	if (!(tool->grid_cells >= 3 && tool->grid_cells <= 1024))
		return cau_fail(error, CAU_BAD_VALUE, "grid_cells", "%g is not in 3 to 1024",
		                tool->grid_cells);
	if (!(step > 0 && step <= thinnest * (1 + 1e-12)))
		return cau_fail(error, CAU_BAD_VALUE, "grid_step_m",
		                "%g m is not above 0 and at most the thinnest hot radius, %g m", step,
		                thinnest);
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

cau_status cau_heat_grid_create(cau_heat_grid *grid, const cau_tool_def *tool, double ambient_c,
                                double tick_s, const cau_pose *pose, cau_error *error)
{
	*grid = (cau_heat_grid){0};
	cau_status status = check(tool, tick_s, error);
	if (status != CAU_OK)
		return status;
	grid->nodes = (int32_t)tool->grid_cells;
	grid->step_m = tool->grid_step_m;
	grid->diffusivity = tool->diffusivity_m2_s;
	grid->ambient_c = ambient_c;
	size_t nodes = (size_t)node_count(grid);
	if (!cau_pages_take(&grid->pages, 3 * nodes * sizeof(float)))
		return cau_fail(error, CAU_NO_MEMORY, "grid_cells", "no memory for %d^3 nodes",
		                (int)tool->grid_cells);
	grid->temperature = grid->pages.start;
	grid->next = grid->temperature + nodes;
	grid->rate = grid->next + nodes;
	origin_for(grid, tool, pose, grid->origin);
	rest(grid);
	return CAU_OK;
}

void cau_heat_grid_finish(cau_heat_grid *grid)
{
	cau_pages_give_back(&grid->pages);
	*grid = (cau_heat_grid){0};
}

// The outer layer of nodes at ambient.
static void reset_boundary(cau_heat_grid *grid, float *field)
{
	int64_t n = grid->nodes;
	float ambient = (float)grid->ambient_c;
	fill(field, n * n, ambient);
	fill(field + n * n * (n - 1), n * n, ambient);
	for (int64_t z = 1; z < n - 1; z++) {
		float *plane = field + z * n * n;
		fill(plane, n, ambient);
		fill(plane + n * (n - 1), n, ambient);
		for (int64_t y = 1; y < n - 1; y++)
			plane[y * n] = plane[y * n + n - 1] = ambient;
	}
}

// Copies the node that is `shift` cells on to each node; nodes from outside are at ambient.
static void copy_shifted(cau_heat_grid *grid, const int64_t shift[3])
{
	int64_t n = grid->nodes;
	int64_t first = shift[0] < 0 ? -shift[0] : 0; // x of the first node that has a source
	int64_t kept = n - (shift[0] < 0 ? -shift[0] : shift[0]);
	CAU_ASSERT(kept > 0 && kept <= n, "%lld of %lld nodes are kept", (long long)kept, (long long)n);
	fill(grid->next, node_count(grid), (float)grid->ambient_c);
	for (int64_t z = 0; z < n; z++)
		for (int64_t y = 0; y < n; y++) {
			int64_t from_y = y + shift[1], from_z = z + shift[2];
			if (from_y < 0 || from_y >= n || from_z < 0 || from_z >= n)
				continue;
			const float *source = grid->temperature + (from_z * n + from_y) * n + first + shift[0];
			memcpy(grid->next + (z * n + y) * n + first, source, (size_t)kept * sizeof(float));
		}
}

static void swap_fields(cau_heat_grid *grid)
{
	float *old = grid->temperature;
	grid->temperature = grid->next;
	grid->next = old;
}

// Moves the grid so that it is centred on the hot part. No value is resampled: nodes keep theirs.
static void follow(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose)
{
	int64_t origin[3], shift[3];
	bool moved = false, leapt = false;
	origin_for(grid, tool, pose, origin);
	for (int axis = 0; axis < 3; axis++) {
		shift[axis] = origin[axis] - grid->origin[axis];
		moved |= shift[axis] != 0;
		leapt |= shift[axis] <= -grid->nodes || shift[axis] >= grid->nodes;
		grid->origin[axis] = origin[axis];
	}
	if (!moved || cau_heat_grid_is_ambient(grid))
		return;
	if (leapt) {
		rest(grid);
		return;
	}
	copy_shifted(grid, shift);
	swap_fields(grid);
	reset_boundary(grid, grid->temperature);
	reset_boundary(grid, grid->next);
}

// What hold_block needs to place a node in the tool's frame: node (x, y, z) is at first + x axis[0]
// + ...
typedef struct hold {
	cau_heat_grid *grid;
	const cau_tool_def *tool;
	double jaw;
	cau_vec3 first;
	cau_vec3 axis[3]; // m in the tool's frame for one cell along the world's x, y, z
} hold;

// Holds the inner nodes of a block of size^3 nodes.
static void hold_whole(const hold *h, const int32_t least[3], int32_t size)
{
	CAU_ASSERT(size >= 1, "a block of %d nodes", size);
	int64_t n = h->grid->nodes;
	int32_t from[3], to[3];
	for (int axis = 0; axis < 3; axis++) {
		from[axis] = least[axis] > 1 ? least[axis] : 1;
		to[axis] = least[axis] + size < n - 1 ? least[axis] + size : (int32_t)n - 1;
	}
	for (int64_t z = from[2]; z < to[2]; z++)
		for (int64_t y = from[1]; y < to[1]; y++)
			for (int64_t x = from[0]; x < to[0]; x++) {
				h->grid->temperature[(z * n + y) * n + x] = (float)h->tool->temperature_c;
				h->grid->rate[(z * n + y) * n + x] = 0;
			}
}

// Holds the hot nodes of a block of size^3 nodes, size a power of two. The distance is 1-Lipschitz:
// its value in the middle decides the whole block, unless the surface may pass through it; then its
// eighths are asked.
static void hold_block(const hold *h, const int32_t least[3], int32_t size)
{
	CAU_ASSERT(size >= 1 && (size & (size - 1)) == 0, "a block of %d nodes", size);
	if (least[0] >= h->grid->nodes || least[1] >= h->grid->nodes || least[2] >= h->grid->nodes)
		return;
	double half = (size - 1) / 2.0;
	cau_vec3 middle = h->first;
	for (int axis = 0; axis < 3; axis++)
		middle = cau_add_scaled(middle, least[axis] + half, h->axis[axis]);
	double step = h->grid->step_m;
	double level = cau_tool_distance(h->tool, h->jaw, CAU_PART_HOT, middle, NULL) - step / 2;
	double corner = sqrt(3) * half * step;
	if (!(level < corner)) // a distance that is not a number holds nothing
		return;
	if (level < -corner) {
		hold_whole(h, least, size);
		return;
	}
	for (int eighth = 0; eighth < 8; eighth++) {
		int32_t part = size / 2;
		hold_block(h,
		           (const int32_t[3]){least[0] + (eighth & 1) * part,
		                              least[1] + (eighth >> 1 & 1) * part,
		                              least[2] + (eighth >> 2) * part},
		           part);
	}
}

// Sets the inner nodes with SDF < dl/2 to the tool's temperature, and their rate to zero.
static void hold_hot(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                     double jaw)
{
	double step = grid->step_m;
	cau_vec3 first = {(double)grid->origin[0] * step, (double)grid->origin[1] * step,
	                  (double)grid->origin[2] * step};
	hold h = {
		.grid = grid,
		.tool = tool,
		.jaw = jaw,
		.first = cau_pose_to_local(pose, first),
		.axis = {cau_rotate_back(pose->rotation, (cau_vec3){step, 0, 0}),
	             cau_rotate_back(pose->rotation, (cau_vec3){0, step, 0}),
	             cau_rotate_back(pose->rotation, (cau_vec3){0, 0, step})},
	};
	int32_t size = 1;
	while (size < grid->nodes)
		size *= 2;
	hold_block(&h, (const int32_t[3]){0, 0, 0}, size);
}

void cau_heat_grid_survey(cau_heat_grid *grid)
{
	CAU_ASSERT(grid->nodes >= 3, "a survey of %d nodes", grid->nodes);
	cau_extremes(grid->temperature, node_count(grid), &grid->coldest_c, &grid->warmest_c);
	if (fabs(grid->coldest_c - grid->ambient_c) <= REST_C &&
	    fabs(grid->warmest_c - grid->ambient_c) <= REST_C)
		rest(grid);
}

void cau_heat_grid_advance(cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                           double jaw, bool energized, double duration_s)
{
	CAU_ASSERT(duration_s >= 0, "a part of %g s", duration_s);
	follow(grid, tool, pose);
	bool heating = energized && cau_tool_thinnest_hot_m(tool) < INFINITY;
	if (cau_heat_grid_is_ambient(grid) && !heating)
		return;
	int64_t substeps = cau_heat_grid_substeps(grid->step_m, grid->diffusivity, duration_s);
	double dt = duration_s / (double)substeps;
	double rate = grid->diffusivity * dt / (grid->step_m * grid->step_m);
	CAU_ASSERT(rate >= 0 && rate <= (1 + 1e-9) / 6, "a rate of %g is not stable", rate);
	fill(grid->rate, node_count(grid), (float)rate);
	if (heating)
		hold_hot(grid, tool, pose, jaw);
	for (int64_t i = 0; i < substeps; i++) {
		cau_diffuse(grid->temperature, grid->rate, grid->next, grid->nodes);
		swap_fields(grid);
	}
	cau_heat_grid_survey(grid);
}

double cau_heat_grid_at(const cau_heat_grid *grid, cau_vec3 point)
{
	const double position[3] = {point.x, point.y, point.z};
	int64_t cell[3], n = grid->nodes;
	double s[3];
	for (int axis = 0; axis < 3; axis++) {
		double nodes = position[axis] / grid->step_m - (double)grid->origin[axis];
		if (!(nodes >= 0 && nodes <= (double)(n - 1)))
			return grid->ambient_c;
		cell[axis] = (int64_t)fmin(floor(nodes), (double)(n - 2));
		s[axis] = nodes - (double)cell[axis];
	}
	const float *corner = grid->temperature + (cell[2] * n + cell[1]) * n + cell[0];
	double sum = 0;
	for (int i = 0; i < 8; i++) {
		int64_t x = i & 1, y = i >> 1 & 1, z = i >> 2;
		double weight = (x ? s[0] : 1 - s[0]) * (y ? s[1] : 1 - s[1]) * (z ? s[2] : 1 - s[2]);
		sum += weight * (double)corner[(z * n + y) * n + x];
	}
	return sum;
}

double cau_heat_grid_warmest(const cau_heat_grid *grid)
{
	return cau_heat_grid_is_ambient(grid) ? grid->ambient_c : (double)grid->warmest_c;
}

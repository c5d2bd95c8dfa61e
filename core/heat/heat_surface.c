// SPDX-License-Identifier: GPL-3.0-or-later
// Holds the hot part at its temperature, with the boundary at its surface instead of at the nearest
// nodes (a ghost-fluid boundary, after Gibou, Fedkiw, Cheng and Kang 2002).
//
// Take a node outside the hot part with a neighbour inside. The surface is theta cells from the
// node towards this neighbour; theta follows from the signed distances of both. The neighbour gets
// the value that continues the field linearly through the tool's temperature T at the surface. So
// its part of the Laplacian, u_neighbour - u, becomes (T - u) / theta.
//
// An explicit step of these terms would need dt <= theta dl^2 / alpha, and theta may be any number
// above 0. So the terms towards the surface use the node's value at the end of the step. They
// contain no other new value, so no system has to be solved:
//
//     u' = u + r / (1 + r S) (sum - 6 u + (S - count) (T - u)),   S = sum over `count` of 1 / theta
//
// `sum` contains the neighbours inside with their stored value T. For every theta and any r up to
// 1/6, new values are means of old values and T. The steady field is that of the terms above, and a
// node on the surface is at T. So no theta needs a limit, and the surface needs no shorter step.
#include "heat/heat_field.h"

#include "cautery/assert.h"

// cells: largest distance from the surface of a node outside that has a neighbour inside
static const double NEAR = 1;
// cells: a node nearer than this to the surface is taken to be on the surface
static const double ON = 1e-4;

// Cells: distance that is stored for nodes that are known to be farther than NEAR. In cells that
// the surface crosses, nodes are no farther than the diagonal of a cell, 1.73.
static const float BEYOND = 1.4F;

// Gives the position of a node in the tool's frame: node (x, y, z) is at first + x axis[0] + y
// axis[1] + z axis[2].
typedef struct search {
	cau_heat_surface *surface;
	int32_t nodes;
	double step_m;
	const cau_tool_def *tool;
	double jaw;
	cau_vec3 first;
	cau_vec3 axis[3]; // m in the tool's frame, for one cell along the world's x, y, z
} search;

static double cells_at(const search *s, double x, double y, double z)
{
	cau_vec3 place = cau_add_scaled(s->first, x, s->axis[0]);
	place = cau_add_scaled(cau_add_scaled(place, y, s->axis[1]), z, s->axis[2]);
	return cau_tool_distance(s->tool, s->jaw, CAU_PART_HOT, place, NULL) / s->step_m;
}

// Sets the distances of a block's nodes to `value`. If `value` is not a number, the distance of
// each node is computed.
static void fill_block(const search *s, const int32_t least[3], int32_t size, float value)
{
	CAU_ASSERT(size >= 1, "a block of %d nodes", size);
	cau_heat_surface *surface = s->surface;
	int32_t n = s->nodes, end[3];
	for (int axis = 0; axis < 3; axis++) {
		end[axis] = least[axis] + size < n ? least[axis] + size : n;
		surface->least[axis] =
			least[axis] < surface->least[axis] ? least[axis] : surface->least[axis];
		surface->end[axis] = end[axis] > surface->end[axis] ? end[axis] : surface->end[axis];
	}
	for (int32_t z = least[2]; z < end[2]; z++)
		for (int32_t y = least[1]; y < end[1]; y++)
			for (int32_t x = least[0]; x < end[0]; x++) {
				float *distance = &surface->distance[((int64_t)z * n + y) * n + x];
				if (!isnan(value)) {
					*distance = value;
					continue;
				}
				double cells = cells_at(s, x, y, z);
				if (!isnan(cells)) // if the distance is not a number, the node is not held
					*distance = fabs(cells) < ON ? 0 : (float)cells;
			}
}

// Finds the distances of a block of size^3 nodes, size a power of two. The distance is 1-Lipschitz.
// So the distance in the block's middle decides for all its nodes, unless the surface may be near
// one of the nodes. In that case the block is divided into eight parts.
static void find_block(const search *s, const int32_t least[3], int32_t size)
{
	CAU_ASSERT(size >= 2 && (size & (size - 1)) == 0, "a block of %d nodes", size);
	const int32_t n = s->nodes;
	if (least[0] >= n || least[1] >= n || least[2] >= n)
		return;
	double half = (size - 1) / 2.0, near = NEAR + sqrt(3) * half;
	double cells = cells_at(s, least[0] + half, least[1] + half, least[2] + half);
	if (!(cells <= near))
		return;
	if (cells < -near || size == 2) {
		fill_block(s, least, size, cells < -near ? -BEYOND : NAN);
		return;
	}
	int32_t part = size / 2;
	for (int eighth = 0; eighth < 8; eighth++)
		find_block(s,
		           (const int32_t[3]){least[0] + (eighth & 1) * part,
		                              least[1] + (eighth >> 1 & 1) * part,
		                              least[2] + (eighth >> 2) * part},
		           part);
}

void cau_heat_surface_find(cau_heat_surface *surface, const cau_heat_field *field, int32_t nodes,
                           const cau_tool_def *tool, const cau_pose *pose, double jaw)
{
	double step = field->step_m;
	cau_vec3 first = {(double)field->origin[0] * step, (double)field->origin[1] * step,
	                  (double)field->origin[2] * step};
	search s = {
		.surface = surface,
		.nodes = nodes,
		.step_m = step,
		.tool = tool,
		.jaw = jaw,
		.first = cau_pose_to_local(pose, first),
		.axis = {cau_rotate_back(pose->rotation, (cau_vec3){step, 0, 0}),
	             cau_rotate_back(pose->rotation, (cau_vec3){0, step, 0}),
	             cau_rotate_back(pose->rotation, (cau_vec3){0, 0, step})},
	};
	int64_t count = (int64_t)nodes * nodes * nodes;
	for (int64_t i = 0; i < count; i++)
		surface->distance[i] = BEYOND;
	for (int axis = 0; axis < 3; axis++) {
		surface->least[axis] = nodes;
		surface->end[axis] = 0;
	}
	int32_t size = 2;
	while (size < nodes)
		size *= 2;
	find_block(&s, (const int32_t[3]){0, 0, 0}, size);
	surface->held = true;
	surface->held_c = (float)tool->temperature_c;
}

// Computes `rate` and `pull` of an inner node outside the hot part, less than a cell from its
// surface.
static void bind(cau_heat_surface *surface, int64_t n, int64_t i, float rate)
{
	const int64_t on[6] = {-1, 1, -n, n, -n * n, n * n};
	const float *d = surface->distance + i;
	CAU_ASSERT(d[0] > 0, "node %lld is within the hot part", (long long)i);
	float towards = 0, count = 0;
	for (int k = 0; k < 6; k++)
		if (d[on[k]] <= 0) {
			float within = d[on[k]] > -1 ? d[on[k]] : -1;
			towards += (d[0] - within) / d[0];
			count += 1;
		}
	surface->rate[i] = rate / (1 + rate * towards);
	surface->pull[i] = towards - count;
}

static void hold_node(cau_heat_surface *surface, cau_heat_field *field, int64_t n,
                      const int64_t node[3], float rate)
{
	int64_t i = (node[2] * n + node[1]) * n + node[0];
	bool outer = false;
	for (int axis = 0; axis < 3; axis++)
		outer |= node[axis] == 0 || node[axis] == n - 1;
	if (surface->distance[i] <= 0) {
		field->temperature[i] = field->next[i] = surface->held_c;
		surface->rate[i] = 0;
	} else if (surface->distance[i] < 1 && !outer) {
		bind(surface, n, i, rate);
	}
}

void cau_heat_surface_hold(cau_heat_surface *surface, cau_heat_field *field, int32_t nodes,
                           double rate)
{
	int64_t n = nodes;
	CAU_ASSERT(surface->held && n >= 3, "%d nodes, none of them held", nodes);
	for (int64_t i = 0; i < n * n * n; i++) {
		surface->rate[i] = (float)rate;
		surface->pull[i] = 0;
	}
	for (int64_t z = surface->least[2]; z < surface->end[2]; z++)
		for (int64_t y = surface->least[1]; y < surface->end[1]; y++)
			for (int64_t x = surface->least[0]; x < surface->end[0]; x++)
				if (surface->distance[(z * n + y) * n + x] < 1)
					hold_node(surface, field, n, (const int64_t[3]){x, y, z}, (float)rate);
}

// Reads the field near the surface. The field has a kink at the surface. So nodes inside the hot
// part are read as if the outer field continued through the surface. Their values follow from their
// distances, and from the mean of (u - T) / distance over the cell's outer nodes.
double cau_heat_surface_at(const cau_heat_surface *surface, const cau_heat_field *field,
                           int32_t nodes, const cau_heat_cell *cell)
{
	double distance = 0, rise = 0, outside = 0, sum = 0, depth = 0, held = (double)surface->held_c;
	for (int i = 0; i < 8 && surface->held; i++) {
		int64_t node = cau_heat_cell_node(cell, nodes, i);
		double weight = cell->weight[i], d = (double)surface->distance[node];
		double u = (double)field->temperature[node];
		distance += weight * d;
		sum += weight * u;
		if (d > 0) {
			outside += weight;
			rise += weight * (u - held) / d;
		} else {
			depth += weight * d;
		}
	}
	if (!surface->held || outside >= 1)
		return cau_heat_cell_mean(cell, field, nodes);
	if (distance <= 0)
		return held;
	double beyond = sum + depth * rise / outside;
	return (beyond - held) * rise > 0 ? beyond : held; // never beyond the tool's temperature
}

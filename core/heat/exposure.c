// SPDX-License-Identifier: GPL-3.0-or-later
// Exposure of edges to heat, the parts of a tick's motion, and ignition temperatures.
#include "heat/exposure.h"

#include "cautery/assert.h"

// ---- exposure
// PARTS_MAX: most parts of a swept motion. CELL_PARTS_MAX: most parts of a motion that is divided
// so that each part is at most half a cell. With four parts, the error of a ball at 50 mm/s in
// cells of a sixth of its radius is within 2 %, and more parts improve it little (README.md).
enum { PARTS_MAX = 32, CELL_PARTS_MAX = 4 };

double cau_exposure_gain(const cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                         double jaw, cau_vec3 a, cau_vec3 b, double absorption_per_s,
                         double duration_s)
{
	CAU_ASSERT(duration_s >= 0 && absorption_per_s >= 0, "exposed for %g s at %g/s", duration_s,
	           absorption_per_s);
	if (cau_heat_grid_warmest(grid) <= CAU_LIVING_C)
		return 0;
	double mean = (cau_heat_grid_at(grid, a) + cau_heat_grid_at(grid, b)) / 2;
	if (mean <= CAU_LIVING_C)
		return 0;
	if (!cau_tool_meets_segment(tool, jaw, CAU_PART_HOT, cau_pose_to_local(pose, a),
	                            cau_pose_to_local(pose, b)))
		return 0;
	return absorption_per_s * mean * duration_s;
}

// Returns the greatest rate of rotation along cau_pose_between, times the duration (rad). A blend
// of quaternions whose rotations differ by theta rotates fastest half way, at 4 tan(theta / 4).
static double turn_between(const cau_pose *from, const cau_pose *to)
{
	double dot = 0;
	for (int i = 0; i < 4; i++)
		dot += from->rotation[i] * to->rotation[i];
	return 4 * tan(acos(fmin(fabs(dot), 1)) / 2);
}

// Returns a bound of the length of the path of any point of the hot part from one pose to the
// other, m.
static double longest_way_m(const cau_tool_def *tool, const cau_pose *from, const cau_pose *to)
{
	cau_vec3 center;
	double radius;
	cau_tool_bound(tool, CAU_PART_HOT, &center, &radius);
	// Radius of a ball around the tip that contains the hot part.
	double reach = cau_length(center) + radius;
	double way = cau_length(cau_sub(cau_vec3_of(to->position_m), cau_vec3_of(from->position_m)));
	CAU_ASSERT(reach >= 0, "a hot part that reaches %g m", reach);
	return way + reach * turn_between(from, to);
}

static int parts_of(double way_m, double each_m, int most)
{
	CAU_ASSERT(each_m > 0, "parts of %g m", each_m);
	return (int)fmin(fmax(ceil(way_m / each_m * (1 - 1e-12)), 1), most);
}

int cau_exposure_parts(const cau_tool_def *tool, const cau_pose *from, const cau_pose *to)
{
	return parts_of(longest_way_m(tool, from, to), cau_tool_thinnest_hot_m(tool) / 2, PARTS_MAX);
}

int cau_heating_parts(const cau_tool_def *tool, const cau_pose *from, const cau_pose *to)
{
	double way = longest_way_m(tool, from, to), thinnest = cau_tool_thinnest_hot_m(tool);
	int swept = parts_of(way, thinnest / 2, PARTS_MAX);
	int in_cells = thinnest < INFINITY ? parts_of(way, tool->grid_step_m / 2, CELL_PARTS_MAX) : 1;
	return swept > in_cells ? swept : in_cells;
}

// ---- ignition
// The output function of the generator splitmix64 (Steele, Lea and Flood 2014): a bijection that
// mixes all bits.
static uint64_t mix(uint64_t value)
{
	value += UINT64_C(0x9E3779B97F4A7C15);
	value = (value ^ (value >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
	value = (value ^ (value >> 27)) * UINT64_C(0x94D049BB133111EB);
	return value ^ (value >> 31);
}

// Returns a uniform number in (0, 1), from the upper 53 bits.
static double unit(uint64_t value)
{
	return ((double)(value >> 11) + 0.5) * 0x1p-53;
}

// Returns a standard normal number by Box-Muller, limited to -3 to 3.
static double normal(uint64_t seed, uint64_t where)
{
	uint64_t first = mix(mix(seed) ^ where);
	uint64_t second = mix(first);
	double g = sqrt(-2 * log(unit(first))) * cos(2 * M_PI * unit(second));
	return fmin(fmax(g, -3), 3);
}

static double ignition(double mean_c, double spread_c, double g)
{
	return fmax(mean_c + spread_c * g, 0.1 * mean_c);
}

double cau_ignition_of(double mean_c, double spread_c, uint64_t seed, int32_t layer, int32_t edge)
{
	CAU_ASSERT(spread_c >= 0, "a spread of %g degC", spread_c);
	CAU_ASSERT(layer >= 0 && edge >= 0, "edge %d of layer %d", edge, layer);
	uint64_t where = (uint64_t)(uint32_t)layer << 32 | (uint32_t)edge;
	return ignition(mean_c, spread_c, normal(seed, where));
}

// ---- bundles
static const double bundle_length = 8; // length of a bundle over its width

static double smooth(double t)
{
	return t * t * (3 - 2 * t);
}

// Returns the draw of one node of the lattice. Each coordinate has 21 bits, so nodes that are far
// apart may have equal draws.
static double node_draw(uint64_t seed, int32_t layer, const int64_t node[3])
{
	uint64_t where = 0;
	for (int c = 0; c < 3; c++)
		where = where << 21 | ((uint64_t)node[c] & 0x1FFFFF);
	return normal(seed ^ mix((uint64_t)(uint32_t)layer + 1), where);
}

double cau_ignition_in_bundles(double mean_c, double spread_c, uint64_t seed, int32_t layer,
                               cau_vec3 place, cau_vec3 fibre, double bundle_m)
{
	CAU_ASSERT(bundle_m > 0, "bundles of %g m", bundle_m);
	CAU_ASSERT(fabs(cau_dot(fibre, fibre) - 1) < 1e-9, "a fibre of length %g", cau_length(fibre));
	// Rest space is compressed along the fibres. Lengths are in cells of the lattice.
	double squeeze = (1 / bundle_length - 1) * cau_dot(place, fibre);
	cau_vec3 squeezed = cau_scale(1 / bundle_m, cau_add(place, cau_scale(squeeze, fibre)));
	double at[3], share[3];
	cau_vec3_to(squeezed, at);
	int64_t low[3];
	for (int c = 0; c < 3; c++) {
		low[c] = (int64_t)floor(at[c]);
		share[c] = smooth(at[c] - (double)low[c]);
	}
	// The weights of the eight corners are scaled so that the sum of draws is standard normal
	// everywhere.
	double sum = 0, squares = 0;
	for (int corner = 0; corner < 8; corner++) {
		int64_t node[3];
		double weight = 1;
		for (int c = 0; c < 3; c++) {
			int high = corner >> c & 1;
			node[c] = low[c] + high;
			weight *= high ? share[c] : 1 - share[c];
		}
		sum += weight * node_draw(seed, layer, node);
		squares += weight * weight;
	}
	return ignition(mean_c, spread_c, fmin(fmax(sum / sqrt(squares), -3), 3));
}

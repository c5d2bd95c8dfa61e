// SPDX-License-Identifier: GPL-3.0-or-later
#include "heat/exposure.h"

#include "cautery/assert.h"

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

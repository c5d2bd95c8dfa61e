// SPDX-License-Identifier: GPL-3.0-or-later
// Grasper: two equal cold jaws, as wide as the shaft. Each turns by half the opening angle about a
// hinge at z = tip_length. Closed, they meet in the plane x = 0, and the tip is between them.
#include "tool/distance.h"
#include "tool/jaw.h"

static double half_thickness(const cau_tool_def *tool)
{
	return cau_blade_half_thickness(tool->shaft_radius_m);
}

static cau_plate plate_of(const cau_tool_def *tool)
{
	double t = half_thickness(tool);
	return cau_plate_of(0, 2 * t, tool->shaft_radius_m, -tool->tip_length_m - t, 0, t);
}

static cau_jaw high_jaw(const cau_tool_def *tool, double jaw)
{
	return cau_jaw_of(1, tool->tip_length_m, jaw * tool->jaw_open_rad / 2);
}

static double grasper_cold(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	cau_vec3 other;
	cau_vec3 *other_gradient = gradient ? &other : NULL;
	cau_plate plate = plate_of(tool);
	cau_jaw high = high_jaw(tool, jaw);
	cau_jaw low = cau_jaw_opposite(&high);
	double nearest = cau_jaw_plate_distance(&low, &plate, point, gradient);
	double next = cau_jaw_plate_distance(&high, &plate, point, other_gradient);
	nearest = cau_distance_nearer(nearest, gradient, next, &other);
	next = cau_shaft_distance(tool, tool->tip_length_m, point, other_gradient);
	return cau_distance_nearer(nearest, gradient, next, &other);
}

static cau_ball grasper_cold_bound(const cau_tool_def *tool)
{
	cau_plate plate = plate_of(tool);
	cau_ball jaws = cau_jaw_plate_bound(tool->tip_length_m, tool->jaw_open_rad / 2, &plate,
	                                    tool->tip_length_m / 2);
	return cau_ball_join(jaws, cau_shaft_bound(tool, tool->tip_length_m));
}

static bool grasper_between(const cau_tool_def *tool, double jaw, cau_vec3 point,
                            double *coordinate)
{
	cau_jaw high = high_jaw(tool, jaw);
	cau_jaw low = cau_jaw_opposite(&high);
	double t = half_thickness(tool);
	return cau_jaws_hold(&low, 0, &high, 0, tool->shaft_radius_m, tool->tip_length_m + t, t, point,
	                     coordinate);
}

static cau_tool_jaws grasper_jaws(const cau_tool_def *tool)
{
	return (cau_tool_jaws){.hinge_m = tool->tip_length_m, .share = {0.5, 0.5}};
}

const cau_tool_family cau_shape_grasper = {
	.cold = grasper_cold,
	.cold_bound = grasper_cold_bound,
	.between = grasper_between,
	.jaws = grasper_jaws,
};

// SPDX-License-Identifier: GPL-3.0-or-later
// Ultrasonic shears. The hot blade is a needle on the axis that does not turn, with its lower end
// around the tip. The cold clamping jaw is on the side of +x and turns by the whole opening angle
// about a hinge at z = tip_length. Closed, the clamp touches the blade at x = hot_radius.
#include "tool/distance.h"
#include "tool/jaw.h"

static double half_thickness(const cau_tool_def *tool)
{
	return cau_blade_half_thickness(tool->hot_radius_m);
}

static cau_plate clamp_plate(const cau_tool_def *tool)
{
	double t = half_thickness(tool);
	double face = tool->hot_radius_m;
	return cau_plate_of(face, face + 2 * t, tool->hot_radius_m, -tool->tip_length_m, 0, t);
}

static cau_jaw clamp_jaw(const cau_tool_def *tool, double jaw)
{
	return cau_jaw_of(1, tool->tip_length_m, jaw * tool->jaw_open_rad);
}

static double shaft_start(const cau_tool_def *tool)
{
	return tool->tip_length_m + tool->hot_radius_m;
}

static double shears_hot(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	cau_vec3 top = {0, 0, tool->tip_length_m};
	return cau_distance_capsule(point, (cau_vec3){0, 0, 0}, top, tool->hot_radius_m, gradient);
}

static double shears_cold(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	cau_vec3 shaft_gradient;
	cau_plate plate = clamp_plate(tool);
	cau_jaw clamp = clamp_jaw(tool, jaw);
	double clamped = cau_jaw_plate_distance(&clamp, &plate, point, gradient);
	double shaft =
		cau_shaft_distance(tool, shaft_start(tool), point, gradient ? &shaft_gradient : NULL);
	return cau_distance_nearer(clamped, gradient, shaft, &shaft_gradient);
}

static cau_ball shears_hot_bound(const cau_tool_def *tool)
{
	double half = tool->tip_length_m / 2;
	return (cau_ball){{0, 0, half}, half + tool->hot_radius_m};
}

static cau_ball shears_cold_bound(const cau_tool_def *tool)
{
	cau_plate plate = clamp_plate(tool);
	cau_ball clamp =
		cau_jaw_plate_bound(tool->tip_length_m, tool->jaw_open_rad, &plate, tool->tip_length_m / 2);
	return cau_ball_join(clamp, cau_shaft_bound(tool, shaft_start(tool)));
}

static double blade_radius(const cau_tool_def *tool)
{
	return tool->hot_radius_m;
}

static bool shears_between(const cau_tool_def *tool, double jaw, cau_vec3 point, double *coordinate)
{
	cau_jaw blade = cau_jaw_of(-1, tool->tip_length_m, 0);
	cau_jaw clamp = clamp_jaw(tool, jaw);
	double face = tool->hot_radius_m; // the blade's face is at -face, on the other side of x = 0
	return cau_jaws_hold(&blade, -face, &clamp, face, tool->hot_radius_m, tool->tip_length_m,
	                     half_thickness(tool), point, coordinate);
}

// Describes the jaws of shears, of which only the clamp turns.
static cau_tool_jaws shears_jaws(const cau_tool_def *tool)
{
	return (cau_tool_jaws){
		.hinge_m = tool->tip_length_m, .face_m = tool->hot_radius_m, .share = {0, 1}};
}

const cau_tool_family cau_shape_shears = {
	.hot = shears_hot,
	.cold = shears_cold,
	.hot_bound = shears_hot_bound,
	.cold_bound = shears_cold_bound,
	.thinnest_hot = blade_radius,
	.between = shears_between,
	.jaws = shears_jaws,
};

// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes with jaws.
#include "tool/distance.h"
#include "tool/family.h"

// ---- grasper
// Grasper: two equal cold jaws, as wide as the shaft. Each turns by half the opening angle about a
// hinge at z = tip_length. Closed, they meet in the plane x = 0, and the tip is between them.

static double grasper_half_thickness(const cau_tool_def *tool)
{
	return cau_blade_half_thickness(tool->shaft_radius_m);
}

static cau_plate grasper_plate_of(const cau_tool_def *tool)
{
	double t = grasper_half_thickness(tool);
	return cau_plate_of(0, 2 * t, tool->shaft_radius_m, -tool->tip_length_m - t, 0, t);
}

static cau_jaw grasper_high_jaw(const cau_tool_def *tool, double jaw)
{
	return cau_jaw_of(1, tool->tip_length_m, jaw * tool->jaw_open_rad / 2);
}

static double grasper_cold(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	cau_vec3 other;
	cau_vec3 *other_gradient = gradient ? &other : NULL;
	cau_plate plate = grasper_plate_of(tool);
	cau_jaw high = grasper_high_jaw(tool, jaw);
	cau_jaw low = cau_jaw_opposite(&high);
	double nearest = cau_jaw_plate_distance(&low, &plate, point, gradient);
	double next = cau_jaw_plate_distance(&high, &plate, point, other_gradient);
	nearest = cau_distance_nearer(nearest, gradient, next, &other);
	next = cau_shaft_distance(tool, tool->tip_length_m, point, other_gradient);
	return cau_distance_nearer(nearest, gradient, next, &other);
}

static cau_ball grasper_cold_bound(const cau_tool_def *tool)
{
	cau_plate plate = grasper_plate_of(tool);
	cau_ball jaws = cau_jaw_plate_bound(tool->tip_length_m, tool->jaw_open_rad / 2, &plate,
	                                    tool->tip_length_m / 2);
	return cau_ball_join(jaws, cau_shaft_bound(tool, tool->tip_length_m));
}

static bool grasper_between(const cau_tool_def *tool, double jaw, cau_vec3 point,
                            double *coordinate)
{
	cau_jaw high = grasper_high_jaw(tool, jaw);
	cau_jaw low = cau_jaw_opposite(&high);
	double t = grasper_half_thickness(tool);
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

// ---- bipolar forceps
// Bipolar forceps: two equal jaws. Each turns by half the opening angle about a hinge at z =
// tip_length. Each has a hot plate inside and a cold back. Closed, the hot plates meet in the plane
// x = 0, and the tip is in that plane between them.

static double bipolar_half_thickness(const cau_tool_def *tool)
{
	return cau_blade_half_thickness(tool->hot_radius_m);
}

// The hot plate ends two half thicknesses below the hinge, so that it never turns into the shaft.
static cau_plate hot_plate(const cau_tool_def *tool)
{
	double t = bipolar_half_thickness(tool);
	double below = -tool->tip_length_m - t;
	return cau_plate_of(0, 2 * t, tool->hot_radius_m, below, -2 * t, t);
}

static cau_plate cold_back(const cau_tool_def *tool)
{
	double t = bipolar_half_thickness(tool);
	double below = -tool->tip_length_m - t;
	return cau_plate_of(2 * t, 4 * t, tool->hot_radius_m, below, 0, t);
}

static cau_jaw bipolar_high_jaw(const cau_tool_def *tool, double jaw)
{
	return cau_jaw_of(1, tool->tip_length_m, jaw * tool->jaw_open_rad / 2);
}

// Returns the distance to a plate on both jaws.
static double pair_distance(const cau_tool_def *tool, double jaw, const cau_plate *plate,
                            cau_vec3 point, cau_vec3 *gradient)
{
	cau_vec3 other;
	cau_jaw high = bipolar_high_jaw(tool, jaw);
	cau_jaw low = cau_jaw_opposite(&high);
	double first = cau_jaw_plate_distance(&low, plate, point, gradient);
	double second = cau_jaw_plate_distance(&high, plate, point, gradient ? &other : NULL);
	return cau_distance_nearer(first, gradient, second, &other);
}

static double bipolar_hot(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	cau_plate plate = hot_plate(tool);
	return pair_distance(tool, jaw, &plate, point, gradient);
}

static double bipolar_cold(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	cau_vec3 shaft_gradient;
	cau_plate back = cold_back(tool);
	double backs = pair_distance(tool, jaw, &back, point, gradient);
	double shaft =
		cau_shaft_distance(tool, tool->tip_length_m, point, gradient ? &shaft_gradient : NULL);
	return cau_distance_nearer(backs, gradient, shaft, &shaft_gradient);
}

static cau_ball bipolar_hot_bound(const cau_tool_def *tool)
{
	cau_plate plate = hot_plate(tool);
	return cau_jaw_plate_bound(tool->tip_length_m, tool->jaw_open_rad / 2, &plate,
	                           tool->tip_length_m / 2);
}

static cau_ball bipolar_cold_bound(const cau_tool_def *tool)
{
	cau_plate back = cold_back(tool);
	cau_ball backs = cau_jaw_plate_bound(tool->tip_length_m, tool->jaw_open_rad / 2, &back,
	                                     tool->tip_length_m / 2);
	return cau_ball_join(backs, cau_shaft_bound(tool, tool->tip_length_m));
}

static bool bipolar_between(const cau_tool_def *tool, double jaw, cau_vec3 point,
                            double *coordinate)
{
	cau_jaw high = bipolar_high_jaw(tool, jaw);
	cau_jaw low = cau_jaw_opposite(&high);
	double t = bipolar_half_thickness(tool);
	return cau_jaws_hold(&low, 0, &high, 0, tool->hot_radius_m, tool->tip_length_m + t, t, point,
	                     coordinate);
}

static cau_tool_jaws bipolar_jaws(const cau_tool_def *tool)
{
	return (cau_tool_jaws){.hinge_m = tool->tip_length_m, .share = {0.5, 0.5}};
}

const cau_tool_family cau_shape_bipolar = {
	.hot = bipolar_hot,
	.cold = bipolar_cold,
	.hot_bound = bipolar_hot_bound,
	.cold_bound = bipolar_cold_bound,
	.thinnest_hot = bipolar_half_thickness,
	.between = bipolar_between,
	.jaws = bipolar_jaws,
};

// ---- shears
// Ultrasonic shears. The hot blade is a needle on the axis that does not turn, with its lower end
// around the tip. The cold clamping jaw is on the side of +x and turns by the whole opening angle
// about a hinge at z = tip_length. Closed, the clamp touches the blade at x = hot_radius.

static double shears_half_thickness(const cau_tool_def *tool)
{
	return cau_blade_half_thickness(tool->hot_radius_m);
}

static cau_plate clamp_plate(const cau_tool_def *tool)
{
	double t = shears_half_thickness(tool);
	double face = tool->hot_radius_m;
	return cau_plate_of(face, face + 2 * t, tool->hot_radius_m, -tool->tip_length_m, 0, t);
}

static cau_jaw clamp_jaw(const cau_tool_def *tool, double jaw)
{
	return cau_jaw_of(1, tool->tip_length_m, jaw * tool->jaw_open_rad);
}

static double shears_shaft_start(const cau_tool_def *tool)
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
	double shaft = cau_shaft_distance(tool, shears_shaft_start(tool), point,
	                                  gradient ? &shaft_gradient : NULL);
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
	return cau_ball_join(clamp, cau_shaft_bound(tool, shears_shaft_start(tool)));
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
	                     shears_half_thickness(tool), point, coordinate);
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

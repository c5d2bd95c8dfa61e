// SPDX-License-Identifier: GPL-3.0-or-later
// Bipolar forceps: two equal jaws. Each turns by half the opening angle about a hinge at z =
// tip_length. Each has a hot plate inside and a cold back. Closed, the hot plates meet in the plane
// x = 0, and the tip is in that plane between them.
#include "tool/distance.h"
#include "tool/jaw.h"

static double half_thickness(const cau_tool_def *tool)
{
	return cau_blade_half_thickness(tool->hot_radius_m);
}

// The hot plate ends two half thicknesses below the hinge, so that it never turns into the shaft.
static cau_plate hot_plate(const cau_tool_def *tool)
{
	double t = half_thickness(tool);
	double below = -tool->tip_length_m - t;
	return cau_plate_of(0, 2 * t, tool->hot_radius_m, below, -2 * t, t);
}

static cau_plate cold_back(const cau_tool_def *tool)
{
	double t = half_thickness(tool);
	double below = -tool->tip_length_m - t;
	return cau_plate_of(2 * t, 4 * t, tool->hot_radius_m, below, 0, t);
}

static cau_jaw high_jaw(const cau_tool_def *tool, double jaw)
{
	return cau_jaw_of(1, tool->tip_length_m, jaw * tool->jaw_open_rad / 2);
}

// Returns the distance to a plate on both jaws.
static double pair_distance(const cau_tool_def *tool, double jaw, const cau_plate *plate,
                            cau_vec3 point, cau_vec3 *gradient)
{
	cau_vec3 other;
	cau_jaw high = high_jaw(tool, jaw);
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
	cau_jaw high = high_jaw(tool, jaw);
	cau_jaw low = cau_jaw_opposite(&high);
	double t = half_thickness(tool);
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
	.thinnest_hot = half_thickness,
	.between = bipolar_between,
	.jaws = bipolar_jaws,
};

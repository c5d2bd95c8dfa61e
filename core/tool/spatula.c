// SPDX-License-Identifier: GPL-3.0-or-later
// Spatula: a hot, rounded blade in the plane y = 0. Its lower end is around the tip.
#include "tool/distance.h"
#include "tool/family.h"

static double half_thickness(const cau_tool_def *tool)
{
	return cau_blade_half_thickness(tool->hot_radius_m);
}

static cau_vec3 core_center(const cau_tool_def *tool)
{
	return (cau_vec3){0, 0, tool->tip_length_m / 2};
}

static cau_vec3 core_half(const cau_tool_def *tool)
{
	return (cau_vec3){tool->hot_radius_m - half_thickness(tool), 0, tool->tip_length_m / 2};
}

static double spatula_hot(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	return cau_distance_rounded_box(point, core_center(tool), core_half(tool), half_thickness(tool),
	                                gradient);
}

static double shaft_start(const cau_tool_def *tool)
{
	return tool->tip_length_m + half_thickness(tool);
}

static double spatula_cold(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	return cau_shaft_distance(tool, shaft_start(tool), point, gradient);
}

static cau_ball spatula_hot_bound(const cau_tool_def *tool)
{
	return (cau_ball){core_center(tool), cau_length(core_half(tool)) + half_thickness(tool)};
}

static cau_ball spatula_cold_bound(const cau_tool_def *tool)
{
	return cau_shaft_bound(tool, shaft_start(tool));
}

const cau_tool_family cau_shape_spatula = {
	.hot = spatula_hot,
	.cold = spatula_cold,
	.hot_bound = spatula_hot_bound,
	.cold_bound = spatula_cold_bound,
	.thinnest_hot = half_thickness,
};

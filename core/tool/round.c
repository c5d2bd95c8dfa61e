// SPDX-License-Identifier: GPL-3.0-or-later
// Sphere: a hot ball about the tip. Capsule: a hot needle whose lower end is the ball about the
// tip.
#include "tool/distance.h"
#include "tool/family.h"

static double hot_radius(const cau_tool_def *tool)
{
	return tool->hot_radius_m;
}

static double sphere_hot(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	cau_vec3 tip = {0, 0, 0};
	return cau_distance_capsule(point, tip, tip, tool->hot_radius_m, gradient);
}

static double sphere_cold(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	return cau_shaft_distance(tool, tool->hot_radius_m, point, gradient);
}

static cau_ball sphere_hot_bound(const cau_tool_def *tool)
{
	return (cau_ball){{0, 0, 0}, tool->hot_radius_m};
}

static cau_ball sphere_cold_bound(const cau_tool_def *tool)
{
	return cau_shaft_bound(tool, tool->hot_radius_m);
}

static double capsule_hot(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	cau_vec3 top = {0, 0, tool->tip_length_m};
	return cau_distance_capsule(point, (cau_vec3){0, 0, 0}, top, tool->hot_radius_m, gradient);
}

static double capsule_cold(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	return cau_shaft_distance(tool, tool->tip_length_m + tool->hot_radius_m, point, gradient);
}

static cau_ball capsule_hot_bound(const cau_tool_def *tool)
{
	double half = tool->tip_length_m / 2;
	return (cau_ball){{0, 0, half}, half + tool->hot_radius_m};
}

static cau_ball capsule_cold_bound(const cau_tool_def *tool)
{
	return cau_shaft_bound(tool, tool->tip_length_m + tool->hot_radius_m);
}

const cau_tool_family cau_shape_sphere = {
	.hot = sphere_hot,
	.cold = sphere_cold,
	.hot_bound = sphere_hot_bound,
	.cold_bound = sphere_cold_bound,
	.thinnest_hot = hot_radius,
};

const cau_tool_family cau_shape_capsule = {
	.hot = capsule_hot,
	.cold = capsule_cold,
	.hot_bound = capsule_hot_bound,
	.cold_bound = capsule_cold_bound,
	.thinnest_hot = hot_radius,
};

// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes without jaws.
#include "tool/distance.h"
#include "tool/family.h"

// ---- sphere, capsule
// Sphere: a hot ball about the tip. Capsule: a hot needle whose lower end is the ball about the
// tip.

static double round_radius(const cau_tool_def *tool)
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
	.thinnest_hot = round_radius,
};

const cau_tool_family cau_shape_capsule = {
	.hot = capsule_hot,
	.cold = capsule_cold,
	.hot_bound = capsule_hot_bound,
	.cold_bound = capsule_cold_bound,
	.thinnest_hot = round_radius,
};

// ---- spatula
// Spatula: a hot, rounded blade in the plane y = 0. Its lower end is around the tip.

static double spatula_half_thickness(const cau_tool_def *tool)
{
	return cau_blade_half_thickness(tool->hot_radius_m);
}

static cau_vec3 core_center(const cau_tool_def *tool)
{
	return (cau_vec3){0, 0, tool->tip_length_m / 2};
}

static cau_vec3 core_half(const cau_tool_def *tool)
{
	return (cau_vec3){tool->hot_radius_m - spatula_half_thickness(tool), 0, tool->tip_length_m / 2};
}

static double spatula_hot(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	return cau_distance_rounded_box(point, core_center(tool), core_half(tool),
	                                spatula_half_thickness(tool), gradient);
}

static double spatula_shaft_start(const cau_tool_def *tool)
{
	return tool->tip_length_m + spatula_half_thickness(tool);
}

static double spatula_cold(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	return cau_shaft_distance(tool, spatula_shaft_start(tool), point, gradient);
}

static cau_ball spatula_hot_bound(const cau_tool_def *tool)
{
	return (cau_ball){core_center(tool),
	                  cau_length(core_half(tool)) + spatula_half_thickness(tool)};
}

static cau_ball spatula_cold_bound(const cau_tool_def *tool)
{
	return cau_shaft_bound(tool, spatula_shaft_start(tool));
}

const cau_tool_family cau_shape_spatula = {
	.hot = spatula_hot,
	.cold = spatula_cold,
	.hot_bound = spatula_hot_bound,
	.cold_bound = spatula_cold_bound,
	.thinnest_hot = spatula_half_thickness,
};

// ---- hook
// Monopolar L hook. The hot wire is a foot along x through the tip, and a heel that bends up. A
// cold, insulated neck leads from above the heel back to the axis, where the shaft begins. As on
// real hooks, the shaft's axis crosses the foot near the foot's middle, and the heel is at the
// shaft's side.

// Returns half the foot's length: toe and heel are at x = +- half_foot.
static double half_foot(const cau_tool_def *tool)
{
	return tool->tip_length_m / 2;
}

// Returns the radius of the heel's centre line.
static double bend_of(const cau_tool_def *tool)
{
	return tool->tip_length_m / 4;
}

typedef struct hook_neck {
	double radius; // radius of the neck, m
	cau_vec3 low;  // one neck radius above the hot heel
	cau_vec3 high; // on the axis, where the shaft's core begins
} hook_neck;

static hook_neck neck_of(const cau_tool_def *tool)
{
	hook_neck neck;
	neck.radius = fmin(tool->hot_radius_m, tool->shaft_radius_m);
	neck.low = (cau_vec3){-half_foot(tool), 0, bend_of(tool) + tool->hot_radius_m + neck.radius};
	double rise = fmax(tool->tip_length_m, tool->shaft_radius_m); // keeps the shaft off the foot
	neck.high = (cau_vec3){0, 0, neck.low.z + rise};
	return neck;
}

static double hook_hot(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	double bend = bend_of(tool);
	cau_vec3 arc_gradient;
	cau_vec3 heel = {bend - half_foot(tool), 0, 0};
	cau_vec3 toe = {half_foot(tool), 0, 0};
	cau_vec3 arc_center = {heel.x, 0, bend};
	double foot = cau_distance_capsule(point, heel, toe, tool->hot_radius_m, gradient);
	double arc = cau_distance_quarter_arc(point, arc_center, bend, tool->hot_radius_m,
	                                      gradient ? &arc_gradient : NULL);
	return cau_distance_nearer(foot, gradient, arc, &arc_gradient);
}

static double hook_shaft_start(const cau_tool_def *tool, const hook_neck *neck)
{
	return neck->high.z - tool->shaft_radius_m;
}

static double hook_cold(const cau_tool_def *tool, double jaw, cau_vec3 point, cau_vec3 *gradient)
{
	(void)jaw;
	hook_neck neck = neck_of(tool);
	cau_vec3 shaft_gradient;
	double bare = cau_distance_capsule(point, neck.low, neck.high, neck.radius, gradient);
	double shaft = cau_shaft_distance(tool, hook_shaft_start(tool, &neck), point,
	                                  gradient ? &shaft_gradient : NULL);
	return cau_distance_nearer(bare, gradient, shaft, &shaft_gradient);
}

static cau_ball hook_hot_bound(const cau_tool_def *tool)
{
	double middle = bend_of(tool) / 2;
	double core = sqrt(half_foot(tool) * half_foot(tool) + middle * middle);
	return (cau_ball){{0, 0, middle}, core + tool->hot_radius_m};
}

static cau_ball hook_cold_bound(const cau_tool_def *tool)
{
	hook_neck neck = neck_of(tool);
	cau_vec3 across = cau_sub(neck.high, neck.low);
	cau_ball ball = {cau_add_scaled(neck.low, 0.5, across), cau_length(across) / 2 + neck.radius};
	return cau_ball_join(ball, cau_shaft_bound(tool, hook_shaft_start(tool, &neck)));
}

static double wire_radius(const cau_tool_def *tool)
{
	return tool->hot_radius_m;
}

const cau_tool_family cau_shape_hook = {
	.hot = hook_hot,
	.cold = hook_cold,
	.hot_bound = hook_hot_bound,
	.cold_bound = hook_cold_bound,
	.thinnest_hot = wire_radius,
};

// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/assert.h"
#include "tool/distance.h"
#include "tool/family.h"

// Finds the ends of the shaft's core. They coincide if the shaft is shorter than it is wide.
static void shaft_core(const cau_tool_def *tool, double start, cau_vec3 *low, cau_vec3 *high)
{
	double radius = tool->shaft_radius_m;
	*low = (cau_vec3){0, 0, start + radius};
	*high = (cau_vec3){0, 0, start + fmax(tool->shaft_length_m - radius, radius)};
}

double cau_shaft_distance(const cau_tool_def *tool, double start, cau_vec3 point,
                          cau_vec3 *gradient)
{
	cau_vec3 low, high;
	shaft_core(tool, start, &low, &high);
	return cau_distance_capsule(point, low, high, tool->shaft_radius_m, gradient);
}

cau_ball cau_shaft_bound(const cau_tool_def *tool, double start)
{
	cau_vec3 low, high;
	shaft_core(tool, start, &low, &high);
	return (cau_ball){cau_scale(0.5, cau_add(low, high)),
	                  (high.z - low.z) / 2 + tool->shaft_radius_m};
}

cau_ball cau_ball_join(cau_ball a, cau_ball b)
{
	CAU_ASSERT(a.radius_m >= 0 && b.radius_m >= 0, "balls of %g and %g m", a.radius_m, b.radius_m);
	cau_vec3 across = cau_sub(b.center, a.center);
	double distance = cau_length(across);
	if (distance + b.radius_m <= a.radius_m)
		return a;
	if (distance + a.radius_m <= b.radius_m)
		return b;
	double radius = (distance + a.radius_m + b.radius_m) / 2;
	return (cau_ball){cau_add_scaled(a.center, (radius - a.radius_m) / distance, across), radius};
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Parts that several shapes have: the shaft, and jaws with rounded plates.
#include "tool/family.h"

#include "cautery/assert.h"
#include "tool/distance.h"

// ---- the shaft
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

// ---- jaws
cau_jaw cau_jaw_of(double side, double hinge, double angle_rad)
{
	CAU_ASSERT(side == 1 || side == -1, "a jaw on side %g", side);
	return (cau_jaw){side, hinge, cos(angle_rad), sin(angle_rad)};
}

cau_plate cau_plate_of(double x_least, double x_most, double half_width, double z_least,
                       double z_most, double rounding)
{
	CAU_ASSERT(rounding >= 0 && half_width >= 0, "a plate %g wide, rounded by %g", half_width,
	           rounding);
	cau_plate plate = {
		.least = {x_least, -fmax(half_width, rounding), z_least},
		.most = {fmax(x_most, x_least + 2 * rounding), fmax(half_width, rounding),
	             fmax(z_most, z_least + 2 * rounding)},
		.rounding = rounding,
	};
	return plate;
}

cau_jaw cau_jaw_opposite(const cau_jaw *jaw)
{
	return (cau_jaw){-jaw->side, jaw->hinge, jaw->cosine, jaw->sine};
}

cau_vec3 cau_jaw_to_own(const cau_jaw *jaw, cau_vec3 point)
{
	double x = jaw->side * point.x;
	double z = point.z - jaw->hinge;
	return (cau_vec3){jaw->cosine * x + jaw->sine * z, point.y, jaw->cosine * z - jaw->sine * x};
}

static cau_vec3 direction_to_tool(const cau_jaw *jaw, cau_vec3 v)
{
	return (cau_vec3){jaw->side * (jaw->cosine * v.x - jaw->sine * v.z), v.y,
	                  jaw->sine * v.x + jaw->cosine * v.z};
}

double cau_jaw_plate_distance(const cau_jaw *jaw, const cau_plate *plate, cau_vec3 point,
                              cau_vec3 *gradient)
{
	CAU_ASSERT(jaw->side == 1 || jaw->side == -1, "a jaw on side %g", jaw->side);
	cau_vec3 center = cau_scale(0.5, cau_add(plate->least, plate->most));
	cau_vec3 half = cau_scale(0.5, cau_sub(plate->most, plate->least));
	cau_vec3 core = {fmax(half.x - plate->rounding, 0), fmax(half.y - plate->rounding, 0),
	                 fmax(half.z - plate->rounding, 0)};
	double distance = cau_distance_rounded_box(cau_jaw_to_own(jaw, point), center, core,
	                                           plate->rounding, gradient);
	if (gradient)
		*gradient = direction_to_tool(jaw, *gradient);
	return distance;
}

// A corner (x, z) turns on a circle about the hinge. The corner's distance from the ball's centre
// below the hinge grows with the angle until the corner is straight above the hinge. So the ball is
// made from the distance at the greatest angle. Corners that start above the hinge are taken to be
// straight above it.
cau_ball cau_jaw_plate_bound(double hinge, double angle_rad, const cau_plate *plate,
                             double center_z)
{
	CAU_ASSERT(center_z <= hinge, "a ball about %g, above the hinge at %g", center_z, hinge);
	double cosine = cos(angle_rad), sine = sin(angle_rad);
	double below = hinge - center_z;
	double farthest = 0; // square of the largest distance, in the plane y = 0
	for (int corner = 0; corner < 4; corner++) {
		double x = corner & 1 ? plate->most.x : plate->least.x;
		double z = corner & 2 ? plate->most.z : plate->least.z;
		double arm_squared = x * x + z * z;
		double lowered = z <= 0 ? -z * cosine - x * sine : -sqrt(arm_squared);
		double squared = below * below + arm_squared - 2 * below * lowered;
		farthest = squared > farthest ? squared : farthest;
	}
	return (cau_ball){{0, 0, center_z}, sqrt(farthest + plate->most.y * plate->most.y)};
}

static double clamp(double value, double least, double most)
{
	return fmin(fmax(value, least), most);
}

bool cau_jaws_hold(const cau_jaw *low, double low_face, const cau_jaw *high, double high_face,
                   double half_width, double reach, double depth, cau_vec3 point,
                   double *coordinate)
{
	CAU_ASSERT(low->side == -high->side, "both jaws on side %g", low->side);
	CAU_ASSERT(depth > 0 && reach >= 0 && half_width >= 0, "jaws %g deep, %g long, %g wide", depth,
	           reach, half_width);
	cau_vec3 in_low = cau_jaw_to_own(low, point);
	cau_vec3 in_high = cau_jaw_to_own(high, point);
	double low_gap = low_face - in_low.x;
	double high_gap = high_face - in_high.x;
	if (low_gap < -depth || high_gap < -depth || fabs(point.y) > half_width)
		return false;
	if (fmax(in_low.z, in_high.z) > 0 || fmin(in_low.z, in_high.z) < -reach)
		return false;
	if (coordinate)
		*coordinate = clamp((low_gap - high_gap) / fmax(low_gap + high_gap, depth), -1, 1);
	return true;
}

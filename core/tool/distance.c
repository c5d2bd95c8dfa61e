// SPDX-License-Identifier: GPL-3.0-or-later
#include "tool/distance.h"

#include "cautery/assert.h"

// Avoids fmax, which would be a library call.
static double greater_of(double a, double b)
{
	return a > b ? a : b;
}

// Returns a unit vector perpendicular to v; e_x if v is zero.
static cau_vec3 perpendicular(cau_vec3 v)
{
	cau_vec3 axis = fabs(v.x) <= fabs(v.y) ? (cau_vec3){1, 0, 0} : (cau_vec3){0, 1, 0};
	return cau_unit_or(cau_cross(cau_cross(v, axis), v), (cau_vec3){1, 0, 0});
}

// Returns the distance to the nearest point of a curve's core, less the tube's radius. If the point
// is on the core, the gradient is perpendicular to the core.
static double tube_distance(cau_vec3 from_core, double radius, cau_vec3 core_direction,
                            cau_vec3 *gradient)
{
	double length = cau_length(from_core);
	if (gradient)
		*gradient = length > 0 ? cau_scale(1 / length, from_core) : perpendicular(core_direction);
	return length - radius;
}

double cau_distance_capsule(cau_vec3 point, cau_vec3 a, cau_vec3 b, double radius,
                            cau_vec3 *gradient)
{
	CAU_ASSERT(!(radius < 0), "a capsule of %g m", radius);
	cau_vec3 along = cau_sub(b, a);
	cau_vec3 from_a = cau_sub(point, a);
	double squared = cau_dot(along, along);
	double s = squared > 0 ? cau_dot(from_a, along) / squared : 0;
	s = s < 0 ? 0 : s > 1 ? 1 : s;
	return tube_distance(cau_add_scaled(from_a, -s, along), radius, along, gradient);
}

// Returns the gradient inside the core box: towards the nearest face.
static cau_vec3 nearest_face(cau_vec3 beyond, cau_vec3 sign)
{
	if (beyond.x >= beyond.y && beyond.x >= beyond.z)
		return (cau_vec3){sign.x, 0, 0};
	if (beyond.y >= beyond.z)
		return (cau_vec3){0, sign.y, 0};
	return (cau_vec3){0, 0, sign.z};
}

double cau_distance_rounded_box(cau_vec3 point, cau_vec3 center, cau_vec3 half, double rounding,
                                cau_vec3 *gradient)
{
	CAU_ASSERT(!(half.x < 0 || half.y < 0 || half.z < 0 || rounding < 0),
	           "a box of %g, %g, %g m, rounded by %g", half.x, half.y, half.z, rounding);
	cau_vec3 p = cau_sub(point, center);
	cau_vec3 sign = {p.x < 0 ? -1 : 1, p.y < 0 ? -1 : 1, p.z < 0 ? -1 : 1};
	cau_vec3 beyond = {fabs(p.x) - half.x, fabs(p.y) - half.y, fabs(p.z) - half.z};
	cau_vec3 outside = {greater_of(beyond.x, 0), greater_of(beyond.y, 0), greater_of(beyond.z, 0)};
	double length = cau_length(outside);
	if (gradient)
		*gradient = length > 0
		                ? (cau_vec3){sign.x * outside.x / length, sign.y * outside.y / length,
		                             sign.z * outside.z / length}
		                : nearest_face(beyond, sign);
	double inside = greater_of(beyond.x, greater_of(beyond.y, beyond.z));
	return length + (inside < 0 ? inside : 0) - rounding;
}

double cau_distance_quarter_arc(cau_vec3 point, cau_vec3 center, double radius, double tube,
                                cau_vec3 *gradient)
{
	CAU_ASSERT(!(radius < 0 || tube < 0), "an arc of %g m, %g thick", radius, tube);
	cau_vec3 p = cau_sub(point, center);
	cau_vec3 core;
	double in_plane = sqrt(p.x * p.x + p.z * p.z);
	if (p.x <= 0 && p.z <= 0 && in_plane > 0)
		core = (cau_vec3){radius * p.x / in_plane, 0, radius * p.z / in_plane};
	else // outside the arc's angle, the nearest point is the nearer end
		core = p.z < p.x ? (cau_vec3){0, 0, -radius} : (cau_vec3){-radius, 0, 0};
	cau_vec3 along = {-core.z, 0, core.x};
	return tube_distance(cau_sub(p, core), tube, along, gradient);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distances (m) to the solids that tools are made of: negative inside, 1-Lipschitz.
// `gradient` (unit, outward; may be NULL) is one of the nearest directions where several are equal.
#pragma once

#include "base/vector.h"

// All points within `radius` of the segment a-b; a ball where a = b.
double cau_distance_capsule(cau_vec3 point, cau_vec3 a, cau_vec3 b, double radius,
                            cau_vec3 *gradient);

// All points within `rounding` of the box center +- half; `half` is not negative, and may be zero
// in any direction (a rounded plate, rod or ball).
double cau_distance_rounded_box(cau_vec3 point, cau_vec3 center, cau_vec3 half, double rounding,
                                cau_vec3 *gradient);

// All points within `tube` of the quarter circle about `center` in the plane y = center.y that runs
// from center - radius e_x to center - radius e_z.
double cau_distance_quarter_arc(cau_vec3 point, cau_vec3 center, double radius, double tube,
                                cau_vec3 *gradient);

// Of two distances with their gradients the smaller one: the union of two solids. `gradient` holds
// the first gradient and is replaced where the second solid is nearer; NULL asks for no gradients.
static inline double cau_distance_nearer(double first, cau_vec3 *gradient, double second,
                                         const cau_vec3 *second_gradient)
{
	if (second < first) {
		if (gradient)
			*gradient = *second_gradient;
		return second;
	}
	return first;
}

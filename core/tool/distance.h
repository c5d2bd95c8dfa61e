// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distances (m) to the solids that tools consist of: negative inside, 1-Lipschitz.
// `gradient` (unit, outward; may be NULL) points away from the nearest surface point. If several
// surface points are equally near, it points away from one of them.
#pragma once

#include "base/vector.h"

// Capsule: all points within `radius` of the segment a-b. It is a ball if a = b.
double cau_distance_capsule(cau_vec3 point, cau_vec3 a, cau_vec3 b, double radius,
                            cau_vec3 *gradient);

// Rounded box: all points within `rounding` of the box center +- half. `half` is not negative, and
// may be zero in any direction (a rounded plate, rod or ball).
double cau_distance_rounded_box(cau_vec3 point, cau_vec3 center, cau_vec3 half, double rounding,
                                cau_vec3 *gradient);

// Quarter arc: all points within `tube` of the quarter circle about `center` in the plane y =
// center.y, from center - radius e_x to center - radius e_z.
double cau_distance_quarter_arc(cau_vec3 point, cau_vec3 center, double radius, double tube,
                                cau_vec3 *gradient);

// Returns the smaller of two distances: the distance to the union of two solids. `gradient` is the
// first gradient, and is replaced by the second if the second solid is nearer. NULL: no gradients
// are needed.
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

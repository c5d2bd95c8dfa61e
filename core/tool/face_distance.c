// SPDX-License-Identifier: GPL-3.0-or-later
#include "tool/tool_shape.h"

#include <string.h>

#include "cautery/assert.h"

static void set_weights(double weight[3], double a, double b, double c)
{
	weight[0] = a;
	weight[1] = b;
	weight[2] = c;
}

void cau_nearest_on_triangle(cau_vec3 point, const cau_vec3 corner[3], double weight[3])
{
	cau_vec3 ab = cau_sub(corner[1], corner[0]), ac = cau_sub(corner[2], corner[0]);
	cau_vec3 ap = cau_sub(point, corner[0]), bp = cau_sub(point, corner[1]);
	cau_vec3 cp = cau_sub(point, corner[2]);
	double d1 = cau_dot(ab, ap), d2 = cau_dot(ac, ap);
	double d3 = cau_dot(ab, bp), d4 = cau_dot(ac, bp);
	double d5 = cau_dot(ab, cp), d6 = cau_dot(ac, cp);
	double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
	if (d1 <= 0 && d2 <= 0) {
		set_weights(weight, 1, 0, 0);
	} else if (d3 >= 0 && d4 <= d3) {
		set_weights(weight, 0, 1, 0);
	} else if (d6 >= 0 && d5 <= d6) {
		set_weights(weight, 0, 0, 1);
	} else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
		double along = d1 / (d1 - d3);
		set_weights(weight, 1 - along, along, 0);
	} else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
		double along = d2 / (d2 - d6);
		set_weights(weight, 1 - along, 0, along);
	} else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
		double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
		set_weights(weight, 0, 1 - along, along);
	} else {
		double sum = va + vb + vc;
		set_weights(weight, 1 - vb / sum - vc / sum, vb / sum, vc / sum);
	}
}

static cau_vec3 weighted(const cau_vec3 corner[3], const double weight[3])
{
	cau_vec3 sum = cau_scale(weight[0], corner[0]);
	return cau_add_scaled(cau_add_scaled(sum, weight[1], corner[1]), weight[2], corner[2]);
}

// Most steps of the search for the least distance. Each step looks for the triangle's point nearest
// to the middle of the tool's rounding. From a point at distance d, this middle is d plus the tip's
// radius away, against the gradient. If the middle is exact, the nearest point on the triangle is
// the answer at once.
enum { STEPS_DOWN = 24 };
// near_enough_m: decrease of the distance, m, below which a step is the last. stays_m: way, m,
// below which a step does not move.
static const double near_enough_m = 1e-7, stays_m = 1e-10;

double cau_tool_face_distance(const cau_tool_def *tool, double jaw, cau_tool_part part,
                              const cau_vec3 corner[3], double weight[3], cau_vec3 *gradient)
{
	CAU_ASSERT(tool->hot_radius_m > 0, "a tip of %g m", tool->hot_radius_m);
	double inside = tool->hot_radius_m;
	cau_vec3 at = weighted(corner, weight);
	double least = cau_tool_distance(tool, jaw, part, at, gradient);
	for (int step = 0; step < STEPS_DOWN; step++) {
		double next_weight[3];
		cau_vec3 next_gradient;
		double far = fmax(least + inside, near_enough_m);
		cau_nearest_on_triangle(cau_add_scaled(at, -far, *gradient), corner, next_weight);
		cau_vec3 next = weighted(corner, next_weight);
		// A triangle point that is nearest to a point inside the tool is also nearest to all points
		// between the two. So the search is at the minimum if it does not move.
		if (cau_length(cau_sub(next, at)) < stays_m)
			break;
		double distance = cau_tool_distance(tool, jaw, part, next, &next_gradient);
		if (!(distance < least)) {
			inside /= 4; // too far: the tool's rounding is smaller there
			continue;
		}
		bool settled = least - distance < near_enough_m;
		least = distance;
		at = next;
		*gradient = next_gradient;
		memcpy(weight, next_weight, sizeof next_weight);
		if (settled)
			break;
	}
	return least;
}

double cau_tool_way_out(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 point,
                        cau_vec3 out, double most_m, cau_vec3 *gradient)
{
	CAU_ASSERT(most_m >= 0, "%g m at most", most_m);
	enum { STEPS_BACK = 48 };
	double height = most_m;
	// Moves from outside towards the surface.
	for (int step = 0; step < STEPS_BACK && height > 0; step++) {
		double distance =
			cau_tool_distance(tool, jaw, part, cau_add_scaled(point, height, out), gradient);
		if (distance <= near_enough_m)
			return height;
		height -= distance;
	}
	return fmax(height, 0);
}

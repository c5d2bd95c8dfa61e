// SPDX-License-Identifier: GPL-3.0-or-later
// Distances between parts of surfaces, after C. Ericson, Real-Time Collision Detection (2005),
// 5.1.5 and 5.1.9.
#include "collide/gap.h"

#include <math.h>

#include "cautery/assert.h"

static double share(double part, double rest)
{
	double whole = part + rest;
	return whole != 0 ? part / whole : 0;
}

static double within_unit(double a)
{
	return a < 0 ? 0 : a > 1 ? 1 : a;
}

// Finds the point on the face of corners 1 to 3 that is nearest to corner 0. `b` is the share of
// each corner in that point.
static void nearest_on_face(const cau_vec3 *corner, double b[3])
{
	cau_vec3 ab = cau_sub(corner[2], corner[1]), ac = cau_sub(corner[3], corner[1]);
	cau_vec3 ap = cau_sub(corner[0], corner[1]), bp = cau_sub(corner[0], corner[2]);
	cau_vec3 cp = cau_sub(corner[0], corner[3]);
	double d1 = cau_dot(ab, ap), d2 = cau_dot(ac, ap), d3 = cau_dot(ab, bp), d4 = cau_dot(ac, bp);
	double d5 = cau_dot(ab, cp), d6 = cau_dot(ac, cp);
	double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
	if (d1 <= 0 && d2 <= 0) {
		b[1] = b[2] = 0;
	} else if (d3 >= 0 && d4 <= d3) {
		b[1] = 1;
		b[2] = 0;
	} else if (d6 >= 0 && d5 <= d6) {
		b[1] = 0;
		b[2] = 1;
	} else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
		b[1] = share(d1, -d3);
		b[2] = 0;
	} else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
		b[1] = 0;
		b[2] = share(d2, -d6);
	} else if (va <= 0 && d4 >= d3 && d5 >= d6) {
		b[2] = share(d4 - d3, d5 - d6);
		b[1] = 1 - b[2];
	} else {
		double sum = va + vb + vc;
		b[1] = sum > 0 ? vb / sum : 0;
		b[2] = sum > 0 ? vc / sum : 0;
	}
	b[0] = 1 - b[1] - b[2];
}

// Finds the nearest points of the two edges. `s` is the position of the point along the first edge,
// 0 to 1, and `t` that along the second edge.
static void nearest_on_edges(const cau_vec3 *corner, double *s, double *t)
{
	cau_vec3 d1 = cau_sub(corner[1], corner[0]), d2 = cau_sub(corner[3], corner[2]);
	cau_vec3 r = cau_sub(corner[0], corner[2]);
	double a = cau_dot(d1, d1), e = cau_dot(d2, d2), f = cau_dot(d2, r);
	double c = cau_dot(d1, r), b = cau_dot(d1, d2), cross = a * e - b * b;
	const double parallel = 1e-12; // square of the sine below which edges count as parallel
	if (!(a > 0) || !(e > 0)) {
		*s = a > 0 ? within_unit(-c / a) : 0;
		*t = e > 0 ? within_unit(f / e) : 0;
		return;
	}
	*s = cross > parallel * a * e ? within_unit((b * f - c * e) / cross) : 0;
	*t = (b * *s + f) / e;
	if (*t < 0 || *t > 1) {
		*t = within_unit(*t);
		*s = within_unit((b * *t - c) / a);
	}
}

// Returns the vector from the second part's nearest point to the first part's.
static cau_vec3 nearest(cau_gap_kind kind, const cau_vec3 *corner, double weight[4])
{
	CAU_ASSERT(kind == CAU_GAP_VERTEX_FACE || kind == CAU_GAP_EDGE_EDGE, "a gap of kind %d", kind);
	if (kind == CAU_GAP_VERTEX_FACE) {
		double b[3];
		nearest_on_face(corner, b);
		weight[0] = 1;
		for (int i = 0; i < 3; i++)
			weight[i + 1] = -b[i];
	} else {
		double s, t;
		nearest_on_edges(corner, &s, &t);
		weight[0] = 1 - s;
		weight[1] = s;
		weight[2] = t - 1;
		weight[3] = -t;
	}
	cau_vec3 way = {0, 0, 0};
	for (int i = 0; i < 4; i++)
		way = cau_add_scaled(way, weight[i], corner[i]);
	return way;
}

cau_gap cau_gap_between(cau_gap_kind kind, const cau_vec3 *corner)
{
	cau_gap gap;
	cau_vec3 way = nearest(kind, corner, gap.weight);
	gap.distance = cau_length(way);
	gap.normal = cau_unit_or(way, (cau_vec3){0, 0, 0});
	return gap;
}

double cau_gap_distance(cau_gap_kind kind, const cau_vec3 *corner)
{
	double weight[4];
	return cau_length(nearest(kind, corner, weight));
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Distances between parts of surfaces: a vertex and a face, or two edges.
#pragma once

#include "base/vector.h"

typedef enum cau_gap_kind {
	CAU_GAP_VERTEX_FACE, // corner 0 and the face of corners 1, 2 and 3
	CAU_GAP_EDGE_EDGE,   // the edge of corners 0 and 1, and the edge of corners 2 and 3
} cau_gap_kind;

// The shortest line between the two parts: the sum of weight[i] x_i is distance * normal. The
// weights of the first part sum to 1, those of the second part to -1. Each end of the line has a
// plane across the normal. Both parts are on the outer sides of these planes, because they are
// convex.
typedef struct cau_gap {
	double distance;  // m
	double weight[4]; // weight of each corner
	cau_vec3 normal;  // unit vector towards the part of corner 0; 0 if the parts meet
} cau_gap;

// Returns the shortest line between the parts. `corner` has four items.
cau_gap cau_gap_between(cau_gap_kind kind, const cau_vec3 *corner);
double cau_gap_distance(cau_gap_kind kind, const cau_vec3 *corner); // returns only the distance, m

// Returns the number of corners that belong to the first part.
static inline int cau_gap_first(cau_gap_kind kind)
{
	return kind == CAU_GAP_VERTEX_FACE ? 1 : 2;
}

// Returns how far the parts are apart along a unit direction, m: the least of the first part's
// corners less the greatest of the second part's corners. This is never more than the distance.
static inline double cau_gap_along(cau_gap_kind kind, const cau_vec3 *corner, cau_vec3 direction)
{
	double along[4];
	for (int i = 0; i < 4; i++)
		along[i] = cau_dot(corner[i], direction);
	double second = along[2] > along[3] ? along[2] : along[3];
	if (kind == CAU_GAP_VERTEX_FACE)
		return along[0] - (along[1] > second ? along[1] : second);
	return (along[0] < along[1] ? along[0] : along[1]) - second;
}

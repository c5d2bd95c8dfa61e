// SPDX-License-Identifier: GPL-3.0-or-later
// Distances between parts of surfaces: a vertex and a face, or two edges.
#pragma once

#include "base/vector.h"

typedef enum cau_gap_kind {
	CAU_GAP_VERTEX_FACE, // corner 0 against the face of 1, 2 and 3
	CAU_GAP_EDGE_EDGE,   // the edge of 0 and 1 against that of 2 and 3
} cau_gap_kind;

// The shortest way between the two parts: sum of weight[i] x_i = distance * normal. Weights of a
// part sum to 1, those of the other to -1. The planes across the normal at its ends have the parts
// on their outer sides, as both are convex.
typedef struct cau_gap {
	double distance;  // m
	double weight[4]; // by corner
	cau_vec3 normal;  // unit, towards the part of corner 0; 0 where the parts meet
} cau_gap;

// `corner`: four.
cau_gap cau_gap_between(cau_gap_kind kind, const cau_vec3 *corner);
double cau_gap_distance(cau_gap_kind kind, const cau_vec3 *corner); // of it alone, m

// How many of the corners are the first part's.
static inline int cau_gap_first(cau_gap_kind kind)
{
	return kind == CAU_GAP_VERTEX_FACE ? 1 : 2;
}

// How far the parts are apart along a unit direction: of the first's corners the least, less the
// most of the second's, m. Never more than the distance.
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

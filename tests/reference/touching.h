// SPDX-License-Identifier: GPL-3.0-or-later
// The exact contacts of a ball with an indented body: vertices, and the point of each face that is
// nearest to the ball's middle. The nearest point moves when the body moves. The second derivative
// of its distance is known in closed form.
#pragma once

#include "reference/indented.h"

typedef struct cau_touching_point { // nearest point on a vertex, an edge or a face
	int corners;                    // number of corners, 1 to 3
	int32_t vertex[3];              // the corners' vertices, in ascending order
	double weight[3];
	double slope[3][3]; // 1/m: gradients of the weights on the edge or face
	double normal[3];   // unit vector, from the ball's middle
	double distance_m;  // distance from the ball's middle
	double gap_m; // distance from the ball's surface; for a point on an edge or face, plus the
	              // allowed depth `dip_m`
	double reaction_n;
} cau_touching_point;

// Finds the points at `position` (m, n x 3) that may come to push, `most` at most. A point that is
// already in `list` keeps its reaction. Returns their number.
int cau_touching_find(const cau_indented_body *body, const cau_indenting_ball *ball,
                      const double *position, cau_touching_point *list, int count, int most);

// Computes the second derivative of the gap (1/m) by the corners a and b.
void cau_touching_bend(const cau_touching_point *p, int a, int b, double bend[3][3]);

// SPDX-License-Identifier: GPL-3.0-or-later
// What a ball touches of an indented body, exactly: vertices, and of each face the point that is
// nearest to its middle, wherever on it that is. As the body moves, so does this point; how much
// its distance bends by that is known in closed form.
#pragma once

#include "reference/indented.h"

typedef struct cau_touching_point { // nearest on a vertex, an edge or a face
	int corners;                    // 1 to 3
	int32_t vertex[3];              // in order
	double weight[3];
	double slope[3][3]; // 1/m: gradients of the weights on the edge or face
	double normal[3];   // unit, from the ball's middle
	double distance_m;  // from its middle
	double gap_m;       // of what may not be inside
	double reaction_n;
} cau_touching_point;

// Finds at `position` (m, n x 3) those that may come to push, at most `most`; each has the reaction
// that it has in `list` already. Returns how many.
int cau_touching_find(const cau_indented_body *body, const cau_indenting_ball *ball,
                      const double *position, cau_touching_point *list, int count, int most);

// Second derivative of the gap (1/m) by its corners a and b.
void cau_touching_bend(const cau_touching_point *p, int a, int b, double bend[3][3]);

// SPDX-License-Identifier: GPL-3.0-or-later
// An element at rest as a volume, and the cells of a grid (cells.h) that lie in it. A triangle is
// as thick as its sheet, and a link is a cylinder.
#pragma once

#include <stdbool.h>

#include "base/vector.h"
#include "tissue/tissue.h"

typedef struct cau_corners {
	int count; // 2: a link, 3: a triangle, 4: a tetrahedron
	const int32_t *vertex;
} cau_corners;

// The first corner, and the edges from it, where the tissue is at `position` (m, vertex_count x 3).
// A triangle's third edge is its unit normal. A link's second and third are unit vectors square to
// it.
void cau_corners_edges(const cau_corners *corners, const double *position, cau_vec3 *first,
                       cau_vec3 edge[3]);

// Rows of the inverse of the matrix with these columns. Returns its determinant.
double cau_edges_invert(const cau_vec3 edge[3], cau_vec3 row[3]);

typedef struct cau_element_shape {
	cau_corners corners;
	cau_vec3 first, edge[3]; // at rest, m
	cau_vec3 row[3];         // of the inverse of the edges: a point's coordinates along them
	double half_m;           // half of a sheet's thickness, a link's radius
	double side_m;           // of a cell
	double reach_m;          // from a cell's middle to its corners
	cau_vec3 reach;          // the same in coordinates along the edges
} cau_element_shape;

// `half_m` is 0 for a tetrahedron.
cau_element_shape cau_element_shape_of(const cau_tissue *tissue, int primitive, int32_t index,
                                       double half_m, double side_m);

// Coordinates of a point at rest along the edges, from the first corner.
cau_vec3 cau_element_coordinates(const cau_element_shape *shape, cau_vec3 point);

cau_vec3 cau_element_corner(const cau_element_shape *shape, int corner);

// Whether a point lies in the element. A sheet counts as thicker by margin_m on each side, and a
// link's radius as longer.
bool cau_element_holds(const cau_element_shape *shape, cau_vec3 point, double margin_m);

// Places of cells from `least` to `most`.
typedef struct cau_cell_box {
	int32_t least[3], most[3];
} cau_cell_box;

// The box around the element.
cau_cell_box cau_element_box(const cau_element_shape *shape);

// Goes to the next place of the box. Returns false if there is none, and `place` is `least` again.
bool cau_cell_box_next(const cau_cell_box *box, int32_t place[3]);

// Middle of the cell at a place.
cau_vec3 cau_element_cell_middle(const cau_element_shape *shape, const int32_t place[3]);

// Whether the cell at a place may have a part in the element. It may be close beside it, too.
bool cau_element_may_meet(const cau_element_shape *shape, const int32_t place[3]);

// Share of the cell at a place that lies in the element, 0 to 1.
float cau_element_share(const cau_element_shape *shape, const int32_t place[3]);

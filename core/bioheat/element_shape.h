// SPDX-License-Identifier: GPL-3.0-or-later
// An element at rest as a volume, and the cells of a grid (cells.h) inside. A triangle is as thick
// as its sheet. A link is a cylinder.
#pragma once

#include <stdbool.h>

#include "base/vector.h"
#include "tissue/tissue.h"

typedef struct cau_corners {
	int count; // 2: a link, 3: a triangle, 4: a tetrahedron
	const int32_t *vertex;
} cau_corners;

// Computes the first corner, and the edges from there to the other corners, for tissue at
// `position` (m, vertex_count x 3). The third edge of a triangle is its unit normal. The second and
// third edge of a link are unit vectors at right angles to the link.
void cau_corners_edges(const cau_corners *corners, const double *position, cau_vec3 *first,
                       cau_vec3 edge[3]);

// Computes the rows of the inverse of the matrix that has the edges as columns. Returns the
// determinant of the matrix.
double cau_edges_invert(const cau_vec3 edge[3], cau_vec3 row[3]);

typedef struct cau_element_shape {
	cau_corners corners;
	cau_vec3 first, edge[3]; // at rest, m
	// Rows of the inverse of the edges: they give a point's coordinates along the edges.
	cau_vec3 row[3];
	double half_m;  // half of a sheet's thickness, a link's radius
	double side_m;  // side of a cell
	double reach_m; // length from a cell's middle to its corners
	cau_vec3 reach; // reach_m in coordinates along the edges
} cau_element_shape;

// Makes the shape of an element at rest. `half_m` is 0 for a tetrahedron.
cau_element_shape cau_element_shape_of(const cau_tissue *tissue, int primitive, int32_t index,
                                       double half_m, double side_m);

// Returns the coordinates of a point at rest along the edges, from the first corner.
cau_vec3 cau_element_coordinates(const cau_element_shape *shape, cau_vec3 point);

// Returns a corner at rest, m.
cau_vec3 cau_element_corner(const cau_element_shape *shape, int corner);

// True if a point is in the element. A sheet is enlarged by margin_m on each side, a link by
// margin_m in its radius.
bool cau_element_holds(const cau_element_shape *shape, cau_vec3 point, double margin_m);

// A box of cells, from `least` to `most`.
typedef struct cau_cell_box {
	int32_t least[3], most[3];
} cau_cell_box;

// Returns the box of cells around the element.
cau_cell_box cau_element_box(const cau_element_shape *shape);

// Moves `place` to the next cell of the box. After the last cell, returns false and sets `place` to
// `least` again.
bool cau_cell_box_next(const cau_cell_box *box, int32_t place[3]);

// Returns the middle of the cell at `place`.
cau_vec3 cau_element_cell_middle(const cau_element_shape *shape, const int32_t place[3]);

// True if the cell at `place` may be partly in the element. Also true for some cells close to the
// element.
bool cau_element_may_meet(const cau_element_shape *shape, const int32_t place[3]);

// Returns the share of the cell at `place` that is in the element, 0 to 1.
float cau_element_share(const cau_element_shape *shape, const int32_t place[3]);

// SPDX-License-Identifier: GPL-3.0-or-later
// The edge-based structure (section 6.1, figure 5): the table lists for every edge the primitives
// that share it. The table of faces is made in the same way: by sorting.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

// The primitives of a tissue over one array of vertices. Hinges are no primitives. A hinge is a
// pair of triangles and exists while both exist.
typedef struct cau_primitives {
	int32_t vertex_count;
	int32_t triangle_count;
	const int32_t *triangle; // (triangle_count x 3)
	int32_t tetrahedron_count;
	const int32_t *tetrahedron; // (tetrahedron_count x 4)
	int32_t link_count;
	const int32_t *link; // (link_count x 2)
} cau_primitives;

// Checks that every index is in [0, vertex_count), that no primitive has a vertex twice, and that
// tables of 32-bit indices can hold all primitives. Errors: CAU_BAD_MESH, which names the
// primitive; CAU_LIMIT.
cau_status cau_primitives_check(const cau_primitives *primitives, cau_error *error);

typedef enum cau_primitive_kind {
	CAU_PRIMITIVE_TRIANGLE,
	CAU_PRIMITIVE_TETRAHEDRON,
	CAU_PRIMITIVE_LINK,
	CAU_PRIMITIVE_KINDS
} cau_primitive_kind;

// Unique edges (a < b), sorted by (a, b). For each kind of primitive there is a compressed list of
// the primitives that share each edge: primitives of edge e are
// sharer[kind][first[kind][e] .. first[kind][e + 1]).
typedef struct cau_edge_table {
	int32_t edge_count;
	int32_t *vertex;                     // (edge_count x 2)
	int32_t *first[CAU_PRIMITIVE_KINDS]; // (edge_count + 1)
	int32_t *sharer[CAU_PRIMITIVE_KINDS];
	int32_t *triangle_edge;  // (triangle_count x 3): edges 01, 12, 20
	int32_t hinge_count;     // edges that exactly two triangles of the same layer share
	int32_t *hinge_edge;     // (hinge_count)
	int32_t *hinge_triangle; // (hinge_count x 2)
} cau_edge_table;

// Builds the table. A hinge joins two triangles with the same value in `triangle_layer`
// (triangle_count).
cau_status cau_edge_table_make(const cau_primitives *primitives, const int32_t *triangle_layer,
                               cau_edge_table *table, cau_error *error);
void cau_edge_table_finish(cau_edge_table *table);

// Returns the edge between two vertices, or -1. Takes O(log edges).
int32_t cau_edge_table_find(const cau_edge_table *table, int32_t a, int32_t b);

// Faces, in the order of the streamed mask: first every triangle of the sheets, then every unique
// face of the tetrahedra. A face of a tetrahedron is drawn while exactly one live tetrahedron has
// the face and no live triangle covers it.
typedef struct cau_face_table {
	int32_t face_count;
	int32_t triangle_count; // faces [0, triangle_count) are the sheets' triangles
	// (face_count x 3); a face of a tetrahedron is counter-clockwise seen from outside owner[0].
	int32_t *vertex;
	// (face_count x 2): tetrahedra that have the face, -1: none; of a sheet's face (-1, -1).
	int32_t *owner;
	int32_t *cover;            // (face_count): triangle with the same three vertices, or -1
	int32_t *tetrahedron_face; // (tetrahedron_count x 4): face opposite vertex 0, 1, 2, 3
	// (triangle_count): face of a tetrahedron with the same three vertices, or -1.
	int32_t *triangle_covers;
} cau_face_table;

cau_status cau_face_table_make(const cau_primitives *primitives, cau_face_table *table,
                               cau_error *error);
void cau_face_table_finish(cau_face_table *table);

// ---- sorting of edges and faces by their vertices
// Sorts the tuples of `tuple` (count x width), whose entries are in [0, bound). Fills order (count)
// with their indices in lexicographic order. Equal tuples keep their order. Uses counting passes:
// O(width (count + bound)). Returns false if memory ran out.
bool cau_index_sort(const int32_t *tuple, int width, int32_t count, int32_t bound, int32_t *order);

// Sorts the entries of a small list in ascending order.
static inline void cau_index_order_row(int32_t *row, int width)
{
	for (int i = 1; i < width; i++)
		for (int j = i; j > 0 && row[j] < row[j - 1]; j--) {
			int32_t larger = row[j - 1];
			row[j - 1] = row[j];
			row[j] = larger;
		}
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Splits cells into tetrahedra: Dompierre et al., "How to subdivide pyramids, prisms, and hexahedra
// into tetrahedra" (1999). The diagonal of every quadrangle starts at the corner whose vertex has
// the lowest index. Cells that share the quadrangle therefore choose the same diagonal. The vertex
// of a cell with the lowest index is the apex. Each face of the cell without this vertex is joined
// to the apex.
#include <string.h>

#include "cautery/assert.h"
#include "mesh/geometry.h"
#include "mesh/mesh_builder.h"

enum { FACES_MAX = 6 };

// Corners of the faces of each shape, counter-clockwise from outside; -1 ends a triangle.
static const struct {
	int face_count;
	int8_t face[FACES_MAX][4];
} shapes[CAU_SHAPE_COUNT] = {
	[CAU_SHAPE_PYRAMID] =
		{5, {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}},
	[CAU_SHAPE_WEDGE] = {5,
                         {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
	[CAU_SHAPE_HEXAHEDRON] =
		{6, {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}},
};

// Returns the index of the corner whose vertex has the lowest representative in `map`.
static int lowest_corner(const int32_t *vertex, int count, const int32_t *map)
{
	int lowest = 0;
	for (int i = 1; i < count; i++)
		if (map[vertex[i]] < map[vertex[lowest]])
			lowest = i;
	return lowest;
}

// Whether the two triangles of a quadrangle that is cut along the diagonal from `corner` face the
// same way.
static bool is_convex_cut(const double *position, const int32_t vertex[4], int corner)
{
	double first[3], second[3];
	const int32_t a[3] = {vertex[corner], vertex[(corner + 1) % 4], vertex[(corner + 2) % 4]};
	const int32_t b[3] = {vertex[corner], vertex[(corner + 2) % 4], vertex[(corner + 3) % 4]};
	cau_triangle_normal(position, a, first);
	cau_triangle_normal(position, b, second);
	return cau_dot3(first, second) > 0;
}

static void split_quadrangle(cau_mesh_builder *builder, const cau_cell *cell, const int32_t *map)
{
	const int32_t *v = cell->vertex;
	const double *position = builder->mesh.position;
	int start = lowest_corner(v, 4, map);
	if (!is_convex_cut(position, v, start) && is_convex_cut(position, v, (start + 1) % 4))
		start = (start + 1) % 4;
	for (int i = 1; i < 3; i++) {
		const int32_t triangle[3] = {v[start], v[(start + i) % 4], v[(start + i + 1) % 4]};
		cau_mesh_builder_triangle(builder, triangle, cell->region, NULL);
	}
	builder->report.split_polygons++;
}

// Adds the tetrahedron (apex, triangle), unless two of its corners are the same vertex. Returns the
// new count.
static int add_cone(int32_t apex, const int32_t triangle[3], const int32_t *map,
                    int32_t (*tetrahedron)[4], int count)
{
	const int32_t t[4] = {apex, triangle[0], triangle[1], triangle[2]};
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < i; j++)
			if (map[t[i]] == map[t[j]])
				return count;
	memcpy(tetrahedron[count], t, sizeof t);
	return count + 1;
}

// Finds the tetrahedra of a cell, at most six. Returns their number.
static int cone_cell(const cau_cell *cell, const int32_t *map, int32_t tetrahedron[12][4])
{
	int count = 0;
	int32_t apex =
		cell->vertex[lowest_corner(cell->vertex, cau_shape_corners((cau_shape)cell->shape), map)];
	for (int f = 0; f < shapes[cell->shape].face_count; f++) {
		const int8_t *face = shapes[cell->shape].face[f];
		int corners = face[3] < 0 ? 3 : 4;
		int32_t vertex[4];
		bool at_apex = false;
		for (int i = 0; i < corners; i++) {
			vertex[i] = cell->vertex[face[i]];
			at_apex = at_apex || map[vertex[i]] == map[apex];
		}
		int start = lowest_corner(vertex, corners, map);
		for (int i = 1; i < corners - 1 && !at_apex; i++) {
			const int32_t triangle[3] = {vertex[start], vertex[(start + i) % corners],
			                             vertex[(start + i + 1) % corners]};
			count = add_cone(apex, triangle, map, tetrahedron, count);
		}
	}
	CAU_ASSERT(count <= 12, "%d tetrahedra of one cell", count);
	return count;
}

// Splits a solid cell. Files number the corners of wedges in two ways, each the mirror image of the
// other. So an inverted wedge is not counted as a fault of the file.
static void split_solid(cau_mesh_builder *builder, const cau_cell *cell, const int32_t *map)
{
	int32_t tetrahedron[12][4];
	int count = cone_cell(cell, map, tetrahedron);
	double volume = 0;
	for (int i = 0; i < count; i++)
		volume += cau_tetrahedron_volume6(builder->mesh.position, tetrahedron[i]);
	for (int i = 0; i < count; i++) {
		int32_t *t = tetrahedron[i], third = t[2];
		if (volume < 0) {
			t[2] = t[3];
			t[3] = third;
		}
		cau_mesh_builder_tetrahedron(builder, t, cell->region);
	}
	builder->report.inverted_tetrahedra += volume < 0 && cell->shape != CAU_SHAPE_WEDGE;
	builder->report.split_hexahedra += cell->shape == CAU_SHAPE_HEXAHEDRON;
	builder->report.split_wedges += cell->shape == CAU_SHAPE_WEDGE;
	builder->report.split_pyramids += cell->shape == CAU_SHAPE_PYRAMID;
	// A flat cell has no tetrahedra.
	builder->report.degenerate_tetrahedra += count == 0;
}

void cau_cell_split(cau_mesh_builder *builder)
{
	if (!builder->cell_count || builder->scan->status)
		return;
	int32_t *map = cau_mesh_array((size_t)builder->mesh.vertex_count, sizeof *map);
	if (!map || !cau_vertex_merge_near(builder->mesh.position, builder->mesh.vertex_count, map)) {
		cau_scan_fail(builder->scan, CAU_NO_MEMORY, "no memory for splitting %d cells",
		              builder->cell_count);
		free(map);
		return;
	}
	for (int32_t i = 0; i < builder->cell_count && !builder->scan->status; i++) {
		cau_cell cell = builder->cell[i];
		if (cell.shape == CAU_SHAPE_QUADRANGLE)
			split_quadrangle(builder, &cell, map);
		else
			split_solid(builder, &cell, map);
	}
	free(map);
}

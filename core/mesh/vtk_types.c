// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/vtk.h"

#include <stdlib.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"

enum { VTK_PIXEL = 8, VTK_VOXEL = 11, KNOWN_TYPES = 82 };

// Types by VTK's own numbers (vtkCellType.h). The corners of a cell are its first points. With the
// shape CAU_SHAPE_COUNT a cell is skipped, or is a polygon.
static const struct {
	const char *name;
	cau_shape shape;
} types[KNOWN_TYPES] = {
	[1] = {"points", CAU_SHAPE_COUNT},
	[2] = {"groups of points", CAU_SHAPE_COUNT},
	[3] = {"lines", CAU_SHAPE_COUNT},
	[4] = {"lines", CAU_SHAPE_COUNT},
	[5] = {"triangles", CAU_SHAPE_TRIANGLE},
	[8] = {"pixels", CAU_SHAPE_QUADRANGLE},
	[9] = {"quadrangles", CAU_SHAPE_QUADRANGLE},
	[10] = {"tetrahedra", CAU_SHAPE_TETRAHEDRON},
	[11] = {"voxels", CAU_SHAPE_HEXAHEDRON},
	[12] = {"hexahedra", CAU_SHAPE_HEXAHEDRON},
	[13] = {"wedges", CAU_SHAPE_WEDGE},
	[14] = {"pyramids", CAU_SHAPE_PYRAMID},
	[15] = {"pentagonal prisms", CAU_SHAPE_COUNT},
	[16] = {"hexagonal prisms", CAU_SHAPE_COUNT},
	[21] = {"3-node lines", CAU_SHAPE_COUNT},
	[22] = {"6-node triangles", CAU_SHAPE_TRIANGLE},
	[23] = {"8-node quadrangles", CAU_SHAPE_QUADRANGLE},
	[24] = {"10-node tetrahedra", CAU_SHAPE_TETRAHEDRON},
	[25] = {"20-node hexahedra", CAU_SHAPE_HEXAHEDRON},
	[26] = {"15-node wedges", CAU_SHAPE_WEDGE},
	[27] = {"13-node pyramids", CAU_SHAPE_PYRAMID},
	[28] = {"9-node quadrangles", CAU_SHAPE_QUADRANGLE},
	[29] = {"27-node hexahedra", CAU_SHAPE_HEXAHEDRON},
	[32] = {"18-node wedges", CAU_SHAPE_WEDGE},
	[33] = {"24-node hexahedra", CAU_SHAPE_HEXAHEDRON},
	[34] = {"7-node triangles", CAU_SHAPE_TRIANGLE},
	[37] = {"19-node pyramids", CAU_SHAPE_PYRAMID},
	[42] = {"polyhedra", CAU_SHAPE_COUNT},
	[68] = {"Lagrange lines", CAU_SHAPE_COUNT},
	[69] = {"Lagrange triangles", CAU_SHAPE_TRIANGLE},
	[70] = {"Lagrange quadrangles", CAU_SHAPE_QUADRANGLE},
	[71] = {"Lagrange tetrahedra", CAU_SHAPE_TETRAHEDRON},
	[72] = {"Lagrange hexahedra", CAU_SHAPE_HEXAHEDRON},
	[73] = {"Lagrange wedges", CAU_SHAPE_WEDGE},
	[74] = {"Lagrange pyramids", CAU_SHAPE_PYRAMID},
	[75] = {"Bezier lines", CAU_SHAPE_COUNT},
	[76] = {"Bezier triangles", CAU_SHAPE_TRIANGLE},
	[77] = {"Bezier quadrangles", CAU_SHAPE_QUADRANGLE},
	[78] = {"Bezier tetrahedra", CAU_SHAPE_TETRAHEDRON},
	[79] = {"Bezier hexahedra", CAU_SHAPE_HEXAHEDRON},
	[80] = {"Bezier wedges", CAU_SHAPE_WEDGE},
	[81] = {"Bezier pyramids", CAU_SHAPE_PYRAMID},
};

// Converts the points of a cell to vertices. Returns false if a point does not exist; the scan has
// then failed.
static bool take_corners(cau_mesh_builder *builder, const int64_t *corner, int64_t corners,
                         int32_t cell, int32_t *vertex)
{
	int32_t count = builder->mesh.vertex_count;
	for (int64_t c = 0; c < corners; c++) {
		if (corner[c] < 0 || corner[c] >= count) {
			cau_scan_fail(builder->scan, CAU_BAD_MESH,
			              "cell %d names point %lld, but there are only %d points so far", cell,
			              (long long)corner[c], count);
			return false;
		}
		vertex[c] = (int32_t)corner[c];
	}
	return true;
}

static void add_polygon(cau_mesh_builder *builder, const int64_t *corner, int64_t corners,
                        int32_t cell)
{
	if (corners < 3) {
		cau_mesh_builder_skip(builder, "polygons of fewer than 3 corners", 1);
		return;
	}
	int32_t *vertex = cau_mesh_array((size_t)corners, sizeof *vertex);
	if (!vertex)
		cau_scan_fail(builder->scan, CAU_NO_MEMORY, "no memory for a polygon");
	else if (take_corners(builder, corner, corners, cell, vertex))
		cau_mesh_builder_polygon(builder, vertex, (int32_t)corners, cell, NULL);
	free(vertex);
}

// Adds a strip of triangles. Every second triangle of a strip has reversed orientation.
static void add_strip(cau_mesh_builder *builder, const int64_t *corner, int64_t corners,
                      int32_t cell)
{
	for (int64_t c = 2; c < corners && !builder->scan->status; c++) {
		const int64_t triangle[3] = {corner[c - 2], corner[c - 1 + c % 2], corner[c - c % 2]};
		add_polygon(builder, triangle, 3, cell);
	}
}

static void add_known(cau_mesh_builder *builder, int64_t type, const int64_t *corner,
                      int64_t corners, int32_t cell)
{
	int32_t vertex[CAU_CORNERS_MAX] = {0};
	int32_t wanted = cau_shape_corners(types[type].shape);
	if (corners < wanted) {
		cau_scan_fail(builder->scan, CAU_BAD_MESH, "cell %d has %lld corners, its type has %d",
		              cell, (long long)corners, wanted);
		return;
	}
	if (!take_corners(builder, corner, wanted, cell, vertex))
		return;
	if (type == VTK_PIXEL || type == VTK_VOXEL) // corners in rows, not around the cell
		for (int i = 2; i < wanted; i += 4) {
			int32_t third = vertex[i];
			vertex[i] = vertex[i + 1];
			vertex[i + 1] = third;
		}
	cau_mesh_builder_cell(builder, types[type].shape, vertex, cell, types[type].name,
	                      corners > wanted);
}

void cau_vtk_add_cell(cau_mesh_builder *builder, int64_t type, const int64_t *corner,
                      int64_t corners, int32_t cell)
{
	CAU_ASSERT(corners >= 0, "a cell of %lld corners", (long long)corners);
	if (builder->scan->status)
		return;
	bool named = type >= 0 && type < KNOWN_TYPES && types[type].name;
	if (type == CAU_VTK_POLYGON && corners <= INT32_MAX)
		add_polygon(builder, corner, corners, cell);
	else if (type == CAU_VTK_STRIP)
		add_strip(builder, corner, corners, cell);
	else if (named && types[type].shape != CAU_SHAPE_COUNT)
		add_known(builder, type, corner, corners, cell);
	else
		cau_mesh_builder_skip(builder, named ? types[type].name : "cells of unknown type", 1);
}

bool cau_vtk_is_region_name(cau_word name)
{
	static const char *const names[] = {"region",        "material",      "MaterialIds",
	                                    "CellEntityIds", "gmsh:physical", "medit:ref"};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (cau_word_is(name, names[i]))
			return true;
	return false;
}

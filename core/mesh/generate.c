// SPDX-License-Identifier: GPL-3.0-or-later
// Generates meshes. The index of a vertex grows fastest along the last axis. Elements are listed
// cell by cell in the same order, so that neighbours are near each other in memory.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"

static cau_status check_sizes(const cau_mesh_def *def, int axes, cau_error *error)
{
	CAU_ASSERT(axes >= 1 && axes <= 3, "%d axes", axes);
	for (int a = 0; a < axes; a++)
		if (!(def->size_m[a] > 0) || !isfinite(def->size_m[a]))
			return cau_fail(error, CAU_BAD_VALUE, "size_m", "size_m[%d] must be above zero", a);
	return CAU_OK;
}

static cau_status check_turn(const cau_mesh_def *def, cau_error *error)
{
	if (isfinite(def->texture_turn_rad))
		return CAU_OK;
	return cau_fail(error, CAU_BAD_VALUE, "texture_turn_rad", "must be a finite angle");
}

// Checks the numbers of cells. Fails also if the cells make more elements than one mesh may have.
static cau_status check_product(const int32_t cells[3], int axes, int elements_per_cell,
                                cau_error *error)
{
	int64_t elements = elements_per_cell;
	for (int a = 0; a < axes; a++) {
		if (cells[a] < 1)
			return cau_fail(error, CAU_BAD_VALUE, "cells", "cells[%d] must be at least 1", a);
		elements *= cells[a];
		if (elements > CAU_MESH_MAX_ELEMENTS)
			return cau_fail(
				error, CAU_LIMIT, "cells",
				"these cells give more than %d elements, which is the limit of one mesh",
				CAU_MESH_MAX_ELEMENTS);
	}
	return CAU_OK;
}

cau_status cau_mesh_check_cells(int source, const int32_t cells[3], cau_error *error)
{
	switch (source) {
	case CAU_MESH_SHEET:
		return check_product(cells, 2, 2, error);
	case CAU_MESH_SLAB:
		return check_product(cells, 3, 6, error);
	case CAU_MESH_PATTERN:
		if (cells[0] < 3 || cells[0] > 1000)
			return cau_fail(error, CAU_BAD_VALUE, "cells",
			                "cells[0] is the number of triangles of the fan, 3 to 1000");
		return CAU_OK;
	default:
		return CAU_OK;
	}
}

// Sets the texture coordinates of each corner: x and y in metres, rotated by `turn_rad`. The map to
// the surface is then an isometry.
static void fill_texture(cau_mesh *mesh, double turn_rad)
{
	CAU_ASSERT(mesh->texture != NULL, "no texture for %d triangles", mesh->triangle_count);
	double c = cos(turn_rad), s = sin(turn_rad);
	for (size_t corner = 0; corner < 3 * (size_t)mesh->triangle_count; corner++) {
		const double *x = mesh->position + 3 * (size_t)mesh->triangle[corner];
		mesh->texture[2 * corner] = c * x[0] + s * x[1];
		mesh->texture[2 * corner + 1] = -s * x[0] + c * x[1];
	}
}

// Sets the vertices of a box of cells. The box is centred in x and y, its top is at z = 0. cells[2]
// = 0 makes a plane.
static void fill_lattice(cau_mesh *mesh, const double size_m[3], const int32_t cells[3])
{
	CAU_ASSERT((int64_t)(cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1) == mesh->vertex_count,
	           "a lattice of %d x %d x %d cells for %d vertices", cells[0], cells[1], cells[2],
	           mesh->vertex_count);
	double *x = mesh->position;
	for (int32_t i = 0; i <= cells[0]; i++)
		for (int32_t j = 0; j <= cells[1]; j++)
			for (int32_t k = 0; k <= cells[2]; k++, x += 3) {
				x[0] = size_m[0] * ((double)i / cells[0] - 0.5);
				x[1] = size_m[1] * ((double)j / cells[1] - 0.5);
				x[2] = cells[2] ? size_m[2] * ((double)k / cells[2] - 1) : 0;
			}
}

// Makes a sheet. Each cell has two triangles, counter-clockwise seen from +z. The diagonal goes
// from the cell's corner of least x and y to that of greatest x and y, as on the top of a slab.
cau_status cau_mesh_make_sheet(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error)
{
	*mesh = (cau_mesh){0};
	cau_status status = check_sizes(def, 2, error);
	if (!status)
		status = check_turn(def, error);
	if (!status)
		status = cau_mesh_check_cells(CAU_MESH_SHEET, def->cells, error);
	if (status)
		return status;

	const int32_t cells[3] = {def->cells[0], def->cells[1], 0};
	int64_t cell_count = (int64_t)cells[0] * cells[1];
	status = cau_mesh_reserve(mesh, ((int64_t)cells[0] + 1) * (cells[1] + 1), 2 * cell_count, 0,
	                          true, error);
	if (status)
		return status;
	fill_lattice(mesh, def->size_m, cells);
	int32_t *triangle = mesh->triangle;
	for (int32_t i = 0; i < cells[0]; i++)
		for (int32_t j = 0; j < cells[1]; j++, triangle += 6) {
			int32_t a = i * (cells[1] + 1) + j, b = a + cells[1] + 1; // b: the next vertex along x
			memcpy(triangle, (int32_t[]){a, b, b + 1, a, b + 1, a + 1}, 6 * sizeof *triangle);
		}
	CAU_ASSERT(triangle == mesh->triangle + 3 * (size_t)mesh->triangle_count,
	           "cells other than %d triangles", mesh->triangle_count);
	fill_texture(mesh, def->texture_turn_rad);
	return CAU_OK;
}

// Sets the six tetrahedra of one cell (Kuhn's subdivision). Each tetrahedron follows a path from
// the cell's least corner to its greatest corner, with another order of the axes. Neighbouring
// cells agree on their common faces.
static void fill_cell(int32_t *tetrahedron, int32_t least, const int32_t stride[3])
{
	static const int8_t walks[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
	                                   {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
	for (int w = 0; w < 6; w++, tetrahedron += 4) {
		int32_t first = least + stride[walks[w][0]];
		int32_t second = first + stride[walks[w][1]];
		bool turned = w >= 3; // odd permutations of the axes have negative volume
		tetrahedron[0] = least;
		tetrahedron[1] = turned ? second : first;
		tetrahedron[2] = turned ? first : second;
		tetrahedron[3] = second + stride[walks[w][2]];
	}
}

cau_status cau_mesh_make_slab(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error)
{
	*mesh = (cau_mesh){0};
	cau_status status = check_sizes(def, 3, error);
	if (!status)
		status = cau_mesh_check_cells(CAU_MESH_SLAB, def->cells, error);
	if (status)
		return status;

	const int32_t *cells = def->cells;
	int64_t cell_count = (int64_t)cells[0] * cells[1] * cells[2];
	status = cau_mesh_reserve(mesh, ((int64_t)cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1), 0,
	                          6 * cell_count, false, error);
	if (status)
		return status;
	CAU_ASSERT(mesh->tetrahedron_count == 6 * cell_count, "%d tetrahedra in %lld cells",
	           mesh->tetrahedron_count, (long long)cell_count);
	fill_lattice(mesh, def->size_m, cells);
	const int32_t stride[3] = {(cells[1] + 1) * (cells[2] + 1), cells[2] + 1, 1};
	int32_t *tetrahedron = mesh->tetrahedron;
	for (int32_t i = 0; i < cells[0]; i++)
		for (int32_t j = 0; j < cells[1]; j++)
			for (int32_t k = 0; k < cells[2]; k++, tetrahedron += 24)
				fill_cell(tetrahedron, i * stride[0] + j * stride[1] + k, stride);
	return CAU_OK;
}

// Makes the pattern of figure 5: a closed fan of cells[0] triangles around vertex 0. The rim is on
// the ellipse with the axes size_m[0] along x and size_m[1] along y. The rim starts on +x.
cau_status cau_mesh_make_pattern(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error)
{
	*mesh = (cau_mesh){0};
	cau_status status = check_sizes(def, 2, error);
	if (!status)
		status = check_turn(def, error);
	if (!status)
		status = cau_mesh_check_cells(CAU_MESH_PATTERN, def->cells, error);
	if (status)
		return status;
	int32_t count = def->cells[0];
	status = cau_mesh_reserve(mesh, (int64_t)count + 1, count, 0, true, error);
	if (status)
		return status;

	const double full_turn_rad = 2 * acos(-1.0);
	for (int32_t i = 0; i < count; i++) {
		double *x = mesh->position + 3 * ((size_t)i + 1);
		x[0] = 0.5 * def->size_m[0] * cos(full_turn_rad * i / count);
		x[1] = 0.5 * def->size_m[1] * sin(full_turn_rad * i / count);
		memcpy(mesh->triangle + 3 * (size_t)i, (int32_t[]){0, 1 + i, 1 + (i + 1) % count},
		       3 * sizeof *mesh->triangle);
	}
	fill_texture(mesh, def->texture_turn_rad);
	return CAU_OK;
}

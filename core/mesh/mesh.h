// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh from a file or a generator: vertices, triangles, tetrahedra. In metres after loading.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

#include "cautery/mesh_scene.h"
#include "cautery/scene.h"
#include "cautery/status.h"

typedef struct cau_mesh {
	int32_t vertex_count;
	int32_t triangle_count;
	int32_t tetrahedron_count;
	double *position; // m, (vertex_count x 3)
	// Vertices, (triangle_count x 3), counter-clockwise seen from outside.
	int32_t *triangle;
	int32_t *triangle_region; // (triangle_count): physical group or material of the file, else 0
	double *texture;          // UV of each corner, (triangle_count x 3 x 2), or NULL
	int32_t *tetrahedron;     // vertices, (tetrahedron_count x 4), positive volume
	// (tetrahedron_count): physical group or material of the file, else 0.
	int32_t *tetrahedron_region;
} cau_mesh;

// ---- storage
// Bounds of any mesh, generated or read. They keep every table over a mesh far below 2^31 entries.
// The largest table has six edges for each tetrahedron.
enum {
	CAU_MESH_MAX_VERTICES = 8000000,
	CAU_MESH_MAX_ELEMENTS = 16000000, // largest number of elements of each kind
};

// Returns `count` zeroed items, or NULL if memory ran out. If `count` is 0, the result is not NULL.
static inline void *cau_mesh_array(size_t count, size_t item_bytes)
{
	return calloc(count ? count : 1, item_bytes);
}

// Gives *mesh zeroed arrays of these sizes. Texture coordinates are allocated only if `texture`.
// Errors: CAU_LIMIT above the bounds, CAU_NO_MEMORY. After an error *mesh is zeroed.
cau_status cau_mesh_reserve(cau_mesh *mesh, int64_t vertex_count, int64_t triangle_count,
                            int64_t tetrahedron_count, bool texture, cau_error *error);
void cau_mesh_finish(cau_mesh *mesh); // frees all arrays; *mesh may be zeroed

// ---- making and reading
// Makes the mesh of `def`: generates the mesh or reads its file or bytes, scales to metres, cleans.
// `directory` resolves relative file names ("" for the working directory). The caller frees *mesh
// with cau_mesh_finish. `report` may be NULL. Errors: CAU_IO; CAU_BAD_SYNTAX, which names line or
// byte; CAU_BAD_MESH, which names the reason. CAU_BAD_MESH is at "unit_m" if no tissue has this
// size, and at "strict" if a strict reading finds a mesh that needs repair.
cau_status cau_mesh_make(const cau_mesh_def *def, const char *directory, cau_mesh *mesh,
                         cau_mesh_report *report, cau_error *error);

// Reads a file's bytes, without scaling or cleaning. The format is found from the bytes. `name` is
// used in messages only. Fills the part of *report about the file. `report` may be NULL.
cau_status cau_mesh_read(const char *name, const void *bytes, size_t byte_count, cau_mesh *mesh,
                         cau_mesh_report *report, cau_error *error);

// Reads a whole regular file of at most 1 GiB. A TetGen mesh has two files of one name (.node, and
// .ele or .face). `path` may name either file, and both are read: points first, then elements. The
// caller frees *bytes. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY.
cau_status cau_mesh_file_load(const char *path, void **bytes, size_t *byte_count, cau_error *error);

// ---- cleaning
// Removes unused vertices. Merges vertices nearer than 1e-5 of the bounding diagonal. Removes
// degenerate elements (relative measure) and repeated elements. Turns inverted tetrahedra. Adds to
// the counts of *report, which may be NULL. Fails with CAU_BAD_MESH if no element is left.
cau_status cau_mesh_clean(cau_mesh *mesh, cau_mesh_report *report, cau_error *error);

// Fills map (vertex_count). Each vertex is mapped to the lowest kept vertex that is nearer than
// 1e-5 of the diagonal of the bounding box, or to itself. `position` is (vertex_count x 3). Returns
// false if memory ran out. Two vertices of a file that are nearer count as one. A file of single
// precision, or with six digits, has its vertices within 1e-6.
bool cau_vertex_merge_near(const double *position, int32_t vertex_count, int32_t *map);

// ---- report and units
// Measures the clean mesh: counts, components, rim, regions, size, unit, quality.
cau_status cau_mesh_report_measure(const cau_mesh *mesh, double unit_m, cau_mesh_report *report,
                                   cau_error *error);

// Fails with CAU_BAD_MESH at "strict" if the mesh was repaired, or if tissue was skipped.
cau_status cau_mesh_report_refuse(const cau_mesh_report *report, cau_error *error);

// Whether a mesh whose longest extent is longest_m can be tissue.
bool cau_is_tissue_size(double longest_m);
// Returns the unit, in m, in which a file with this longest extent is most likely written.
double cau_guess_unit(double longest);
const char *cau_unit_name(double unit_m); // returns for example "millimetres"

// ---- generators
// Generators of meshes (used by deploy/scenes). cau_mesh_def describes the sizes.
cau_status cau_mesh_make_sheet(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);
cau_status cau_mesh_make_slab(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);
cau_status cau_mesh_make_pattern(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);

// Checks the cells of a mesh of this source (CAU_MESH_*). They must be no fewer than the source
// needs, and must not make more elements than one mesh may have. Errors: CAU_BAD_VALUE or CAU_LIMIT
// at "cells".
cau_status cau_mesh_check_cells(int source, const int32_t cells[3], cau_error *error);

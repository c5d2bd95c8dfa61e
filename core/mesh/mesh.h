// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh as read or generated: vertices, triangles, tetrahedra. Metres after loading.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/mesh_scene.h"
#include "cautery/scene.h"
#include "cautery/status.h"

typedef struct cau_mesh {
	int32_t vertex_count;
	int32_t triangle_count;
	int32_t tetrahedron_count;
	double *position;            // m, (vertex_count x 3)
	int32_t *triangle;           // vertices, (triangle_count x 3), counter-clockwise outside
	int32_t *triangle_region;    // (triangle_count): physical group or material of the file, else 0
	double *texture;             // UV of each corner, (triangle_count x 3 x 2), or NULL
	int32_t *tetrahedron;        // vertices, (tetrahedron_count x 4), positive volume
	int32_t *tetrahedron_region; // (tetrahedron_count)
} cau_mesh;

// Makes the mesh of `def`: generates it or reads its file or bytes, scales to metres, cleans it.
// `directory` resolves relative file names ("" for the working directory). The caller finishes
// *mesh. `report` may be NULL. Errors: CAU_IO, CAU_BAD_MESH naming the reason (at "unit_m" for a
// size that no tissue has, at "strict" where a strict reading needs mending), CAU_BAD_SYNTAX naming
// line or byte.
cau_status cau_mesh_make(const cau_mesh_def *def, const char *directory, cau_mesh *mesh,
                         cau_mesh_report *report, cau_error *error);

// Reads a file's bytes, without scaling or cleaning. The format is found from the bytes; `name` is
// for messages only. Fills what the report says of the file. `report` may be NULL.
cau_status cau_mesh_read(const char *name, const void *bytes, size_t byte_count, cau_mesh *mesh,
                         cau_mesh_report *report, cau_error *error);

// Drops unused vertices, merges vertices nearer than 1e-5 of the bounding diagonal, leaves out
// degenerate elements (relative measure) and repeated ones, turns inverted tetrahedra. Adds to the
// counts of *report, which may be NULL. CAU_BAD_MESH where nothing is left.
cau_status cau_mesh_clean(cau_mesh *mesh, cau_mesh_report *report, cau_error *error);

// CAU_BAD_MESH at "strict" where something had to be mended, or tissue was passed over.
cau_status cau_mesh_report_refuse(const cau_mesh_report *report, cau_error *error);

// Whether a mesh this long can be tissue.
bool cau_is_tissue_size(double longest_m);
// The unit, in m, in which a file of this longest extent is most likely written.
double cau_guess_unit(double longest);
const char *cau_unit_name(double unit_m); // "millimetres"

// Generators (deploy/scenes). See cau_mesh_def for sizes.
cau_status cau_mesh_make_sheet(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);
cau_status cau_mesh_make_slab(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);
cau_status cau_mesh_make_pattern(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);

// Whether a mesh of this source (CAU_MESH_*) may have these cells: no fewer than it needs, and no
// more elements than one mesh may have. CAU_BAD_VALUE or CAU_LIMIT at "cells".
cau_status cau_mesh_check_cells(int source, const int32_t cells[3], cau_error *error);

void cau_mesh_finish(cau_mesh *mesh); // frees all arrays; a zeroed mesh is fine

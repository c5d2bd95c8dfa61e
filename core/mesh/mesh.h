// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh as read or generated: vertices, triangles, tetrahedra. Metres after loading.
#pragma once

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

// What cleaning did, for the session's log.
typedef struct cau_mesh_report {
	int32_t unused_vertices;
	int32_t duplicate_vertices;
	int32_t inverted_tetrahedra; // turned to positive volume
	int32_t duplicate_elements;
} cau_mesh_report;

// Makes the mesh of `def`: generates it or reads its file or bytes, scales to metres, cleans it.
// `directory` resolves relative file names ("" for the working directory). The caller finishes
// *mesh. Errors: CAU_IO, CAU_BAD_MESH naming element and reason, CAU_BAD_SYNTAX naming line or
// byte.
cau_status cau_mesh_make(const cau_mesh_def *def, const char *directory, cau_mesh *mesh,
                         cau_mesh_report *report, cau_error *error);

// Reads a file's bytes by the ending of `name` (.msh, .obj, .vtk), without scaling or cleaning.
cau_status cau_mesh_read(const char *name, const void *bytes, size_t byte_count, cau_mesh *mesh,
                         cau_error *error);

// Drops unused vertices, merges vertices nearer than 1e-9 of the bounding diagonal, turns inverted
// tetrahedra, drops repeated elements; refuses degenerate ones (relative measure) by number.
cau_status cau_mesh_clean(cau_mesh *mesh, cau_mesh_report *report, cau_error *error);

// Generators (deploy/scenes). See cau_mesh_def for sizes.
cau_status cau_mesh_make_sheet(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);
cau_status cau_mesh_make_slab(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);
cau_status cau_mesh_make_pattern(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);

// Whether a mesh of this source (CAU_MESH_*) may have these cells: no fewer than it needs, and no
// more elements than one mesh may have. CAU_BAD_VALUE or CAU_LIMIT at "cells".
cau_status cau_mesh_check_cells(int source, const int32_t cells[3], cau_error *error);

void cau_mesh_finish(cau_mesh *mesh); // frees all arrays; a zeroed mesh is fine

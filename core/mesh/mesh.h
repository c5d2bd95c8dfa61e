// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh from a file or a generator: vertices, triangles, tetrahedra. In metres after loading.
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
	double *position; // m, (vertex_count x 3)
	// Vertices, (triangle_count x 3), counter-clockwise seen from outside.
	int32_t *triangle;
	int32_t *triangle_region; // (triangle_count): physical group or material of the file, else 0
	double *texture;          // UV of each corner, (triangle_count x 3 x 2), or NULL
	int32_t *tetrahedron;     // vertices, (tetrahedron_count x 4), positive volume
	// (tetrahedron_count): physical group or material of the file, else 0.
	int32_t *tetrahedron_region;
} cau_mesh;

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

// Removes unused vertices. Merges vertices nearer than 1e-5 of the bounding diagonal. Removes
// degenerate elements (relative measure) and repeated elements. Turns inverted tetrahedra. Adds to
// the counts of *report, which may be NULL. Fails with CAU_BAD_MESH if no element is left.
cau_status cau_mesh_clean(cau_mesh *mesh, cau_mesh_report *report, cau_error *error);

// Fails with CAU_BAD_MESH at "strict" if the mesh was repaired, or if tissue was skipped.
cau_status cau_mesh_report_refuse(const cau_mesh_report *report, cau_error *error);

// Whether a mesh whose longest extent is longest_m can be tissue.
bool cau_is_tissue_size(double longest_m);
// Returns the unit, in m, in which a file with this longest extent is most likely written.
double cau_guess_unit(double longest);
const char *cau_unit_name(double unit_m); // returns for example "millimetres"

// Generators of meshes (used by deploy/scenes). cau_mesh_def describes the sizes.
cau_status cau_mesh_make_sheet(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);
cau_status cau_mesh_make_slab(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);
cau_status cau_mesh_make_pattern(const cau_mesh_def *def, cau_mesh *mesh, cau_error *error);

// Checks the cells of a mesh of this source (CAU_MESH_*). They must be no fewer than the source
// needs, and must not make more elements than one mesh may have. Errors: CAU_BAD_VALUE or CAU_LIMIT
// at "cells".
cau_status cau_mesh_check_cells(int source, const int32_t cells[3], cau_error *error);

void cau_mesh_finish(cau_mesh *mesh); // frees all arrays; *mesh may be zeroed

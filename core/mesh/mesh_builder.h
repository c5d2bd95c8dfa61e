// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh that grows while a file is read. Failures go to the scan, which tells where.
#pragma once

#include "mesh/mesh.h"
#include "mesh/scan.h"

enum { CAU_SKIPPED_KINDS = 256 };

typedef struct cau_mesh_builder {
	cau_scan *scan; // borrowed
	cau_mesh mesh;  // texture follows the triangles where `texture` is set
	bool texture;
	int32_t vertex_capacity;
	int32_t triangle_capacity;
	int32_t tetrahedron_capacity;
	int64_t skipped[CAU_SKIPPED_KINDS]; // elements of other kinds, by the file's own number
} cau_mesh_builder;

// Appends; refuses coordinates that are not finite.
void cau_mesh_builder_vertex(cau_mesh_builder *builder, const double position[3]);
// `vertex` must be inside the vertices so far; `texture` (3 x 2) or NULL.
void cau_mesh_builder_triangle(cau_mesh_builder *builder, const int32_t vertex[3], int32_t region,
                               const double *texture);
void cau_mesh_builder_tetrahedron(cau_mesh_builder *builder, const int32_t vertex[4],
                                  int32_t region);
void cau_mesh_builder_skip(cau_mesh_builder *builder, int64_t kind, int64_t count);

// Fails where neither triangles nor tetrahedra were found, saying what was; name_of names a kind.
void cau_mesh_builder_check(cau_mesh_builder *builder, const char *(*name_of)(int kind));

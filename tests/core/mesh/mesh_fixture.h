// SPDX-License-Identifier: GPL-3.0-or-later
// Functions that several tests of meshes use.
#pragma once

// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <stdlib.h>
#include <string.h>

#include "cautery/defaults.h"
#include "mesh/edge_table.h"
#include "mesh/mesh.h"

// Returns the definition of a generated mesh with this many cells and a size of 12 x 10 x 0.8 cm.
static inline cau_mesh_def fixture_def(int32_t x, int32_t y, int32_t z)
{
	cau_mesh_def def;
	cau_default_mesh_def(&def);
	memcpy(def.size_m, (double[]){0.12, 0.10, 0.008}, sizeof def.size_m);
	memcpy(def.cells, (int32_t[]){x, y, z}, sizeof def.cells);
	return def;
}

static inline cau_primitives fixture_primitives(const cau_mesh *mesh)
{
	return (cau_primitives){.vertex_count = mesh->vertex_count,
	                        .triangle_count = mesh->triangle_count,
	                        .triangle = mesh->triangle,
	                        .tetrahedron_count = mesh->tetrahedron_count,
	                        .tetrahedron = mesh->tetrahedron};
}

// Returns six times the volume of a tetrahedron.
static inline double fixture_volume6(const double *position, const int32_t *t)
{
	double e[3][3];
	for (int i = 0; i < 3; i++)
		for (int c = 0; c < 3; c++)
			e[i][c] = position[3 * t[i + 1] + c] - position[3 * t[0] + c];
	return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
	       e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
	       e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

// Computes (b - a) x (c - a) of a face.
static inline void fixture_normal(const double *position, const int32_t *f, double normal[3])
{
	double e[2][3];
	for (int i = 0; i < 2; i++)
		for (int c = 0; c < 3; c++)
			e[i][c] = position[3 * f[i + 1] + c] - position[3 * f[0] + c];
	for (int c = 0; c < 3; c++)
		normal[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
}

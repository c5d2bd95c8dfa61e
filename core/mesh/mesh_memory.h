// SPDX-License-Identifier: GPL-3.0-or-later
// Storage of a mesh, and the largest size of a mesh.
#pragma once

#include <stdbool.h>
#include <stdlib.h>

#include "mesh/mesh.h"

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

// SPDX-License-Identifier: GPL-3.0-or-later
// Storage of a mesh, and how large a mesh may be.
#pragma once

#include <stdbool.h>
#include <stdlib.h>

#include "mesh/mesh.h"

// Bounds of any mesh, generated or read. They keep every table over a mesh (six edges a
// tetrahedron) far below 2^31 entries.
enum {
	CAU_MESH_MAX_VERTICES = 8000000,
	CAU_MESH_MAX_ELEMENTS = 16000000, // of each kind
};

// `count` zeroed items; never NULL for want of items. NULL: memory ran out.
static inline void *cau_mesh_array(size_t count, size_t item_bytes)
{
	return calloc(count ? count : 1, item_bytes);
}

// Gives *mesh zeroed arrays of these counts (no texture unless asked for).
// Errors: CAU_LIMIT above the bounds, CAU_NO_MEMORY; *mesh is then zeroed.
cau_status cau_mesh_reserve(cau_mesh *mesh, int64_t vertex_count, int64_t triangle_count,
                            int64_t tetrahedron_count, bool texture, cau_error *error);

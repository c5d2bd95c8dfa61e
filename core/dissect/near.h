// SPDX-License-Identifier: GPL-3.0-or-later
// Broad phase: finds the vertices, edges and faces near a tool. Vertices are grouped in blocks by
// rest position (Morton order). Each block has one box around its own vertices, and one around the
// edges and faces that it owns. Boxes are fitted again every tick.
#pragma once

#include <stdbool.h>

#include "base/memory.h"
#include "base/vector.h"
#include "tissue/tissue.h"

enum { CAU_NEAR_BLOCK = 32 };

typedef struct cau_box {
	float least[3], most[3];
} cau_box;

typedef struct cau_near {
	int32_t block_count;
	int32_t *vertex;     // (vertex_count): vertices in the order of blocks
	int32_t *halo_first; // (block_count + 1): start of each block's other ends of edges, in `halo`
	int32_t *halo;
	int32_t *edge_first; // (block_count + 1): start of the edges that each block owns
	int32_t *edge;
	int32_t *face_first; // (block_count + 1): start of the faces that each block owns: those whose
	                     // least vertex is in the block
	int32_t *face;
	cau_box *vertex_box, *edge_box; // (block_count): boxes of each block
	int32_t vertex_count;
} cau_near;

cau_status cau_near_create(cau_near *near, const cau_tissue *tissue, cau_arena *arena,
                           cau_error *error);

// Fits all boxes to positions x (m, vertex_count x 3).
void cau_near_refit(cau_near *near, const double *position);

// Extends the vertex boxes, but no edge box, so that they also contain positions x.
void cau_near_cover(cau_near *near, const double *position);

// True if a box meets the sphere.
bool cau_box_meets(const cau_box *box, cau_vec3 center, double radius_m);

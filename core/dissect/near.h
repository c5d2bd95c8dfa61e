// SPDX-License-Identifier: GPL-3.0-or-later
// Broad phase: what is near a tool. Vertices are grouped in blocks by rest position (Morton order);
// each block has a box round its own vertices and one round the edges and faces it owns, refitted
// every tick.
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
	int32_t *vertex;     // (vertex_count): by block
	int32_t *halo_first; // (block_count + 1): other ends of the block's edges
	int32_t *halo;
	int32_t *edge_first; // (block_count + 1): edges owned by the block
	int32_t *edge;
	int32_t *face_first; // (block_count + 1): faces whose least vertex is the block's
	int32_t *face;
	cau_box *vertex_box, *edge_box; // (block_count)
	int32_t vertex_count;
} cau_near;

cau_status cau_near_create(cau_near *near, const cau_tissue *tissue, cau_arena *arena,
                           cau_error *error);

// Fits the boxes to positions x (m, vertex_count x 3).
void cau_near_refit(cau_near *near, const double *position);

// Grows the vertices' boxes, and no edge's, until they hold positions x as well.
void cau_near_cover(cau_near *near, const double *position);

// Whether a box meets the sphere.
bool cau_box_meets(const cau_box *box, cau_vec3 center, double radius_m);

// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that can touch: faces that are drawn, their edges and vertices, in blocks of faces
// that lie together at rest. The order follows from which faces are drawn alone.
#pragma once

#include <stdbool.h>

#include "base/memory.h"
#include "tissue/tissue.h"

enum { CAU_SURFACE_BLOCK = 32 }; // faces

// Parts of one kind: those of block b are item[first[b]] to item[first[b + 1]].
typedef struct cau_surface_parts {
	int32_t count;
	int32_t *item;  // faces, edges or vertices of the tissue
	int32_t *first; // (block_count + 1)
} cau_surface_parts;

typedef struct cau_surface {
	const cau_tissue *tissue;
	bool listed;    // ever
	uint32_t *mask; // of the faces that are listed
	int32_t block_count, most_blocks;
	cau_surface_parts faces, edges, vertices;
	int32_t *order;       // (face_count): all faces, by place at rest
	int32_t *face_edge;   // (face_count x 3): found when a face is first drawn; -1
	uint8_t *edge_seen;   // (edge_count): scratch
	uint8_t *vertex_seen; // (vertex_count): scratch
} cau_surface;

cau_status cau_surface_create(cau_surface *surface, const cau_tissue *tissue, cau_arena *arena,
                              cau_error *error);

// Lists what is drawn, if that has changed: a set bit of `face_mask` is a face that is not.
void cau_surface_list(cau_surface *surface, const uint32_t *face_mask);

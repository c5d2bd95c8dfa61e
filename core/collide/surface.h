// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that can touch: faces that are drawn, their edges and vertices, in blocks of faces
// that lie together at rest. Which faces a block may have is fixed; what it lists, and in what
// order, follows from which faces are drawn alone.
#pragma once

#include <stdbool.h>

#include "base/memory.h"
#include "tissue/tissue.h"

enum {
	CAU_SURFACE_BLOCK = 32,  // faces that a block draws while nothing is cut, and
	CAU_SURFACE_FACES = 256, // faces that it has, drawn or not, at most
};

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
	int32_t block_count;
	cau_surface_parts faces, edges, vertices;
	int32_t *order; // (face_count): all faces, by place at rest
	int32_t *own;   // (block_count + 1): block b has the faces order[own[b]] to order[own[b + 1]]
	int32_t *face_edge; // (face_count x 3): found when a face is first drawn; -1
	// Blocks that list an edge or a vertex, -1: none; of this list and of the one before.
	int32_t *edge_block[2], *vertex_block[2];
	// (vertex_count): corners of parts whose listing changed: ended, began, or went to another
	// block. The reader clears it
	uint8_t *changed;
} cau_surface;

cau_status cau_surface_create(cau_surface *surface, const cau_tissue *tissue, cau_arena *arena,
                              cau_error *error);

// Lists what is drawn, if that has changed: a set bit of `face_mask` is a face that is not.
void cau_surface_list(cau_surface *surface, const uint32_t *face_mask);

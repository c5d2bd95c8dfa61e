// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that can touch: the drawn faces with their edges and vertices, in blocks of faces
// that are near each other at rest. The faces that a block may list are fixed. A block's lists and
// their order depend only on which faces are drawn.
#pragma once

#include <stdbool.h>

#include "base/memory.h"
#include "tissue/tissue.h"

enum {
	CAU_SURFACE_BLOCK = 32,  // faces that a block draws before anything is cut
	CAU_SURFACE_FACES = 256, // most faces of a block, drawn or not
};

// Parts of one kind: those of block b are item[first[b]] to item[first[b + 1]].
typedef struct cau_surface_parts {
	int32_t count;
	int32_t *item;  // faces, edges or vertices of the tissue
	int32_t *first; // (block_count + 1)
} cau_surface_parts;

typedef struct cau_surface {
	const cau_tissue *tissue;
	bool listed;    // cau_surface_list was called before
	uint32_t *mask; // bits of the faces that are not drawn, as last listed
	int32_t block_count;
	cau_surface_parts faces, edges, vertices;
	int32_t *order; // (face_count): all faces, ordered by position at rest
	int32_t *own;   // (block_count + 1): block b has the faces order[own[b]] to order[own[b + 1]]
	int32_t *face_edge; // (face_count x 3): edges, found when a face is first drawn; -1 before
	// The block that lists each edge or vertex; -1: no block. Index 0: present lists, 1: the lists
	// before.
	int32_t *edge_block[2], *vertex_block[2];
	// (vertex_count): corners of parts whose listing began, ended or moved to another block. The
	// reader clears the marks.
	uint8_t *changed;
} cau_surface;

cau_status cau_surface_create(cau_surface *surface, const cau_tissue *tissue, cau_arena *arena,
                              cau_error *error);

// Lists the drawn faces, if they have changed. A set bit of `face_mask` is a face that is not
// drawn.
void cau_surface_list(cau_surface *surface, const uint32_t *face_mask);

// SPDX-License-Identifier: GPL-3.0-or-later
// Medit's keywords, which text files and binary files share.
#pragma once

#include "mesh/mesh_builder.h"

typedef struct cau_medit_kind {
	const char *keyword;
	int code; // code in a binary file (libMeshb); 0: the keyword exists in text only
	int nodes;
	cau_shape shape; // CAU_SHAPE_COUNT: the element is skipped
	const char *name;
} cau_medit_kind;

// Returns the kind of elements of a keyword or code, or NULL if it names no elements.
const cau_medit_kind *cau_medit_kind_by_keyword(cau_word keyword);
const cau_medit_kind *cau_medit_kind_by_code(int64_t code);

// Appends an element. Nodes in `node` count from 1. Fails if a node does not exist.
void cau_medit_add(cau_mesh_builder *builder, const cau_medit_kind *kind, const int64_t *node,
                   int64_t region);

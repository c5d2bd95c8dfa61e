// SPDX-License-Identifier: GPL-3.0-or-later
// Medit's keywords, which its text and its binary form share.
#pragma once

#include "mesh/mesh_builder.h"

typedef struct cau_medit_kind {
	const char *keyword;
	int code; // in a binary file (libMeshb); 0: text alone
	int nodes;
	cau_shape shape; // CAU_SHAPE_COUNT: passed over
	const char *name;
} cau_medit_kind;

// NULL: no kind of elements.
const cau_medit_kind *cau_medit_kind_by_keyword(cau_word keyword);
const cau_medit_kind *cau_medit_kind_by_code(int64_t code);

// Appends an element; `node` counts from 1. Fails where a node is not there.
void cau_medit_add(cau_mesh_builder *builder, const cau_medit_kind *kind, const int64_t *node,
                   int64_t region);

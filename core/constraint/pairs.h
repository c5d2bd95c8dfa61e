// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles in pairs that share an edge, tetrahedra in pairs that share a face. The local step
// handles a pair at once: two tetrahedra have five vertices to read and to add to, where by
// themselves they have eight.
#pragma once

#include "tissue/tissue.h"

// For each triangle or tetrahedron of one layer and material its partner there, -1 where none is
// left, in `partner` (by element); others are left as they are. Returns the number of pairs, those
// of one counted too.
int32_t cau_pair_elements(const cau_tissue *tissue, int kind, int32_t layer, int32_t material,
                          int32_t *partner);

// An element's vertices as its pair has them: the shared ones, in the order of `first`'s own, then
// its apex. `order` (3 or 4) holds places among the element's own vertices; `first` and `other` are
// the pair, `other` -1 where there is none.
void cau_pair_order(const cau_tissue *tissue, int kind, int32_t first, int32_t other,
                    int32_t element, int *order);

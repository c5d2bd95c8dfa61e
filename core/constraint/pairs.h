// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs triangles that share an edge, and tetrahedra that share a face. The local step handles a
// pair together. A pair of tetrahedra has five vertices to read and to add to; two separate
// tetrahedra have eight.
#pragma once

#include "tissue/tissue.h"

// Sets the partner of each triangle or tetrahedron of one layer and material. The partner is an
// element of the same layer and material, or -1 if no neighbour is left. `partner` is by element;
// entries of elements of other layers or materials are unchanged. Returns the number of pairs, in
// which an element without a partner is a pair of its own.
int32_t cau_pair_elements(const cau_tissue *tissue, int kind, int32_t layer, int32_t material,
                          int32_t *partner);

// Finds the order of an element's vertices in its pair: the shared vertices, in the order of
// `first`'s own, then the apex. `order` (3 or 4) has indices among the element's own vertices.
// `first` and `other` are the pair; `other` is -1 if there is no partner.
void cau_pair_order(const cau_tissue *tissue, int kind, int32_t first, int32_t other,
                    int32_t element, int *order);

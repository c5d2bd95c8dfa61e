// SPDX-License-Identifier: GPL-3.0-or-later
// Functions shared by the files that lay out elements.
#pragma once

#include "constraint/elements_make.h"

static inline int32_t cau_slots_padded(int32_t count)
{
	return (count + CAU_BATCH - 1) / CAU_BATCH * CAU_BATCH;
}

// ---- elements_pairs.c
// Maps between slots and elements, and arrays by slot. The functions that return
// bool return false if there is no memory.
cau_status cau_elements_make_maps(cau_element_slots *slots, int kind, int32_t element_count,
                                  int32_t slot_count, cau_arena *arena, cau_error *error);
void cau_elements_assign(cau_element_slots *slots, int kind, int32_t element, int32_t slot);
bool cau_real_arrays(cau_arena *arena, void **array, int count, int32_t slots, bool single);
bool cau_index_arrays(cau_arena *arena, uint16_t **array, int count, int32_t slots);

// The vertices of elements, by slot. Used until the elements have records.
typedef struct cau_slot_vertices {
	cau_arena arena;
	int32_t *at[CAU_ELEMENT_KINDS][4];
} cau_slot_vertices;
bool cau_slot_vertices_make(cau_slot_vertices *vertices, int kind, int count, int32_t slots);

// Pairs triangles that share an edge, and tetrahedra that share a face. The local step handles a
// pair together. A pair of tetrahedra has five vertices to read and to add to; two separate
// tetrahedra have eight.
//
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

// Makes the sheet and fat sets.
cau_status cau_elements_make_pairs(const cau_tissue *tissue, cau_elements *elements,
                                   cau_element_slots *slots, cau_slot_vertices *vertices,
                                   cau_arena *arena, cau_error *error);

// ---- elements_records.c
// Make the shares and the records. Called in this order, after the sets are
// made.
cau_status cau_elements_make_work(const cau_tissue *tissue, cau_elements *elements,
                                  cau_element_slots *slots, cau_arena *arena, cau_error *error);
cau_status cau_elements_make_records(const cau_tissue *tissue, cau_elements *elements,
                                     cau_element_slots *slots, const cau_slot_vertices *vertices,
                                     cau_arena *arena, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// Functions shared by the files that lay out elements.
#pragma once

#include "constraint/elements_make.h"

static inline int32_t cau_slots_padded(int32_t count)
{
	return (count + CAU_BATCH - 1) / CAU_BATCH * CAU_BATCH;
}

// elements_arrays.c: maps between slots and elements, and arrays by slot. The functions that return
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

// elements_pairs.c: makes the sheet and fat sets
cau_status cau_elements_make_pairs(const cau_tissue *tissue, cau_elements *elements,
                                   cau_element_slots *slots, cau_slot_vertices *vertices,
                                   cau_arena *arena, cau_error *error);

// elements_records.c: make the shares and the records. Called in this order, after the sets are
// made.
cau_status cau_elements_make_work(const cau_tissue *tissue, cau_elements *elements,
                                  cau_element_slots *slots, cau_arena *arena, cau_error *error);
cau_status cau_elements_make_records(const cau_tissue *tissue, cau_elements *elements,
                                     cau_element_slots *slots, const cau_slot_vertices *vertices,
                                     cau_arena *arena, cau_error *error);

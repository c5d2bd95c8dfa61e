// SPDX-License-Identifier: GPL-3.0-or-later
// Lays out a tissue's elements in slots (elements.h), and updates the slots when elements or
// materials change.
#pragma once

#include "base/memory.h"
#include "constraint/elements.h"
#include "solve/kernels.h"
#include "tissue/tissue.h"

typedef struct cau_element_slots {
	int32_t *slot_of[CAU_ELEMENT_KINDS];    // slot of each element, by kind
	int32_t *element_at[CAU_ELEMENT_KINDS]; // element of each slot, by kind; -1: padding
	int32_t work_count;
	cau_local_work *work;    // shares of the local step
	cau_incidence incidence; // records of each vertex
} cau_element_slots;

cau_status cau_elements_make(const cau_tissue *tissue, bool single, cau_arena *arena,
                             cau_elements *elements, cau_element_slots *slots, cau_error *error);

// Removes the element from the local step: its weight becomes 0.
void cau_elements_remove(cau_elements *elements, const cau_element_slots *slots, int kind,
                         int32_t element);

// Sets the target T^(1/2) of a triangle (3 numbers: 00, 11, 01) or a tetrahedron (6: 00, 11, 22,
// 01, 02, 12), in the axes of its F. For a tetrahedron this also turns on its limit.
void cau_elements_set_target(cau_elements *elements, const cau_element_slots *slots,
                             const cau_tissue *tissue, int kind, int32_t element,
                             const double *root);
void cau_elements_target(const cau_elements *elements, const cau_element_slots *slots, int kind,
                         int32_t element, double *root);

// Sets the laws of all groups from the tissue's materials. Slots keep their weights and targets.
void cau_elements_set_laws(cau_elements *elements, const cau_tissue *tissue);

// Marks the batches in which a slot's target differs from its group's (`targeted`). Called after
// laws or targets changed.
void cau_elements_mark_targets(cau_elements *elements, const cau_element_slots *slots);

// Sets weights and laws again from the tissue's materials. Removed elements (`alive` 0) stay
// removed. Shrunk triangles and tetrahedra (`shrunk` 1) keep their targets.
void cau_elements_set_materials(cau_elements *elements, const cau_element_slots *slots,
                                const cau_tissue *tissue, uint8_t *const alive[CAU_ELEMENT_KINDS],
                                uint8_t *const shrunk[2]);

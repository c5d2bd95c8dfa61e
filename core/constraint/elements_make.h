// SPDX-License-Identifier: GPL-3.0-or-later
// Lays a tissue's elements out in slots (elements.h) and keeps slots and elements in step.
#pragma once

#include "base/memory.h"
#include "constraint/elements.h"
#include "solve/kernels.h"
#include "tissue/tissue.h"

typedef struct cau_element_slots {
	int32_t *slot_of[CAU_ELEMENT_KINDS];    // by element
	int32_t *element_at[CAU_ELEMENT_KINDS]; // by slot, -1: padding
	int32_t work_count;
	cau_local_work *work;    // the local step's shares
	cau_incidence incidence; // records of each vertex
} cau_element_slots;

cau_status cau_elements_make(const cau_tissue *tissue, bool single, cau_arena *arena,
                             cau_elements *elements, cau_element_slots *slots, cau_error *error);

// Takes the element out of the local step (weight 0).
void cau_elements_remove(cau_elements *elements, const cau_element_slots *slots, int kind,
                         int32_t element);

// Sets the target T^(1/2) of a triangle (3 numbers: 00, 11, 01) or tetrahedron (6: 00, 11, 22, 01,
// 02, 12), in the axes of its F; a tetrahedron's limit is switched on.
void cau_elements_set_target(cau_elements *elements, const cau_element_slots *slots,
                             const cau_tissue *tissue, int kind, int32_t element,
                             const double *root);
void cau_elements_target(const cau_elements *elements, const cau_element_slots *slots, int kind,
                         int32_t element, double *root);

// Sets the groups' laws from the tissue's materials; slots keep their weights and targets.
void cau_elements_set_laws(cau_elements *elements, const cau_tissue *tissue);

// Marks batches whose targets are not their group's (`targeted`), after laws or targets changed.
void cau_elements_mark_targets(cau_elements *elements, const cau_element_slots *slots);

// Sets weights and laws again from the tissue's materials, keeping removed elements removed
// (`alive`) and shrunk targets (`shrunk`: bytes by triangle and tetrahedron).
void cau_elements_set_materials(cau_elements *elements, const cau_element_slots *slots,
                                const cau_tissue *tissue, uint8_t *const alive[CAU_ELEMENT_KINDS],
                                uint8_t *const shrunk[2]);

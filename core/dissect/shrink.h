// SPDX-License-Identifier: GPL-3.0-or-later
// Shrinkage of what a cut lays bare, or of what heat has denatured (section 6.3, eq. 21).
#pragma once

#include "constraint/elements_make.h"
#include "dissect/dissection.h"

typedef struct cau_shrinking { // an element on its way to its target
	int32_t kind, element;
	double from[6], to[6]; // T^(1/2)
	double age_s;
} cau_shrinking;

// A cut bares a strip at a time, and each element shrinks for 0.2 s. An eighth of all elements is
// far more than that, and small tissues have capacity for all. An element beyond the capacity gets
// its target at once.
enum { CAU_SHRINKING_LEAST = 1024, CAU_SHRINKING_SHARE = 8 };

typedef struct cau_shrink {
	uint8_t *shrunk[2];   // by triangle, by tetrahedron: has its target, once for ever
	int32_t active_count; // on their way
	int32_t active_capacity;
	cau_shrinking *active; // (active_capacity)
} cau_shrink;

cau_status cau_shrink_create(cau_shrink *shrink, const cau_tissue *tissue, cau_arena *arena,
                             cau_error *error);

// Gives every live element that shares a face (tetrahedron) or an edge (triangle) with one in
// removed[first .. count) its target T' = T^(1/2) R^T diag(S) R T^(1/2), R's first axis the
// normalised F^T N_c with N_c the gradient of the hot part's signed distance at the contact point.
void cau_shrink_expose(cau_shrink *shrink, const cau_dissection *dissection, int32_t first,
                       const double *position, const cau_tool_def *tool, const cau_pose *pose,
                       double jaw, cau_elements *elements, const cau_element_slots *slots);

// Gives a live element its target once it is denatured. R's first axis is the gradient of the
// temperature, which it has at its corners, degC: towards a hot part this is N_c. The second is any
// axis that is normal to it.
void cau_shrink_denatured(cau_shrink *shrink, const cau_dissection *dissection, int kind,
                          int32_t element, const double temperature[4], cau_elements *elements,
                          const cau_element_slots *slots);

// Moves the targets on by one tick; they arrive after 0.2 s.
void cau_shrink_advance(cau_shrink *shrink, const cau_tissue *tissue, double step_s,
                        cau_elements *elements, const cau_element_slots *slots);

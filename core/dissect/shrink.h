// SPDX-License-Identifier: GPL-3.0-or-later
// Shrinkage of tissue that a cut exposes or that heat has denatured (section 6.3, eq. 21).
#pragma once

#include "constraint/elements_make.h"
#include "dissect/dissection.h"

typedef struct cau_shrinking { // an element that is shrinking towards its target
	int32_t kind, element;
	double from[6], to[6]; // T^(1/2) at the start, and the target's
	double age_s;
} cau_shrinking;

// CAU_SHRINKING_LEAST is the least capacity for shrinking elements. Large tissues have capacity for
// all elements over CAU_SHRINKING_SHARE. A cut exposes a strip at a time, and each element shrinks
// for 0.2 s. An eighth of all elements is far more than such a strip, and small tissues have
// capacity for all elements. An element beyond the capacity gets its target at once.
enum { CAU_SHRINKING_LEAST = 1024, CAU_SHRINKING_SHARE = 8 };

typedef struct cau_shrink {
	uint8_t *shrunk[2];   // by triangle, by tetrahedron: 1 once the element has its target, which
	                      // never changes again
	int32_t active_count; // elements that are shrinking now
	int32_t active_capacity;
	cau_shrinking *active; // (active_capacity): elements that are shrinking
} cau_shrink;

cau_status cau_shrink_create(cau_shrink *shrink, const cau_tissue *tissue, cau_arena *arena,
                             cau_error *error);

// Starts to shrink every live element that shares a face (tetrahedron) or an edge (triangle) with
// one of the elements removed[first .. count). The element's target is T' = T^(1/2) R^T diag(S) R
// T^(1/2). R's first axis is the normalised F^T N_c. N_c is the gradient of the hot part's signed
// distance at the contact point.
void cau_shrink_expose(cau_shrink *shrink, const cau_dissection *dissection, int32_t first,
                       const double *position, const cau_tool_def *tool, const cau_pose *pose,
                       double jaw, cau_elements *elements, const cau_element_slots *slots);

// Starts to shrink a live element if it is denatured. R's first axis is the gradient of
// `temperature`, which has the values at the element's corners, degC. If heat comes from a hot
// part, this gradient is N_c. The second axis is any axis perpendicular to the first.
void cau_shrink_denatured(cau_shrink *shrink, const cau_dissection *dissection, int kind,
                          int32_t element, const double temperature[4], cau_elements *elements,
                          const cau_element_slots *slots);

// Moves all targets by one tick. They reach their final value after 0.2 s.
void cau_shrink_advance(cau_shrink *shrink, const cau_tissue *tissue, double step_s,
                        cau_elements *elements, const cau_element_slots *slots);

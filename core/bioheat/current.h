// SPDX-License-Identifier: GPL-3.0-or-later
// The electric potential around electrodes, div(sigma grad phi) = 0, and the heat of its current.
// At a generator's frequency the field settles in microseconds, so it is steady in each step.
#pragma once

#include "bioheat/bioheat.h"

typedef struct cau_electrode_cell { // a cell that current enters from an electrode
	int32_t cell;
	double over_length_m; // area over the length from the electrode to the cell's middle
	double potential;     // of that electrode: 1, or 0 for the other jaw
} cau_electrode_cell;

typedef struct cau_current {
	int32_t electrode_count;
	cau_electrode_cell *electrode; // (capacity), set by callers before a solve
	double *potential; // (capacity): V at 1 V; the start of the next solve, so part of the state
	// Results of the last solve.
	double conductance_s; // between the electrodes, or to the return electrode: heat at 1 V
	double returned_s;    // what arrives at 0 V for each volt; equal to it within the residual
	double far_w;         // at 1 V: heat beyond the region
	double residual;      // of the equations, relative to the current that enters
	int32_t iterations;
	// Scratch: the region, its equations (face conductances, S) and vectors.
	int32_t count;
	int32_t *cell;  // (capacity)
	int32_t *seed;  // (capacity): the cell at an electrode that each was reached from
	int32_t *slot;  // (capacity): place of a cell in the region, from 1 on; 0: it is not in it
	double *face_s; // (capacity x 6)
	double *to_electrode_s, *to_far_s, *diagonal_s; // (capacity)
	double *source, *vector[4];                     // (capacity)
} cau_current;

// Room for as many cells as `bioheat` has. CAU_NO_MEMORY.
cau_status cau_current_create(cau_current *current, const cau_bioheat *bioheat, cau_arena *arena,
                              cau_error *error);

// Solves within reach_m of the electrodes. Where tissue goes on beyond, and `grounded`, the
// potential falls as it does far from a single electrode; else nothing flows there. Stops at a
// relative residual of `tolerance`, or after `most` iterations of conjugate gradients.
void cau_current_solve(cau_current *current, const cau_bioheat *bioheat, double reach_m,
                       bool grounded, double tolerance, int32_t most);

// Adds to bioheat->power_w the heat, W, that the current makes in each cell of the region at
// `voltage` (root mean square) between the electrodes.
void cau_current_heat(const cau_current *current, cau_bioheat *bioheat, double voltage);

// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the electric potential around electrodes, div(sigma grad phi) = 0, and the heat of the
// current. At a generator's frequency the field settles in microseconds, so the field is steady in
// each step.
#pragma once

#include "bioheat/bioheat.h"

typedef struct cau_electrode_cell { // a cell that touches an electrode
	int32_t cell;
	double over_length_m; // area over the length from the electrode to the cell's middle
	double potential;     // potential of the electrode: 1, or 0 for the other jaw
} cau_electrode_cell;

typedef struct cau_current {
	int32_t electrode_count;
	cau_electrode_cell *electrode; // (capacity), set by callers before a solve
	// (capacity): V at 1 V between the electrodes. The next solve starts from these potentials, so
	// they are part of the state.
	double *potential;
	// Results of the last solve.
	double conductance_s; // conductance between the electrodes, or to the return electrode: heat at
	                      // 1 V
	// Current that arrives at 0 V, per volt; equals conductance_s within the residual.
	double returned_s;
	double far_w;    // heat beyond the region, at 1 V
	double residual; // residual of the equations, relative to the current that enters
	int32_t iterations;
	// Scratch: the cells of the region, the equations (conductances, S) and vectors.
	int32_t count;
	int32_t *cell;  // (capacity)
	int32_t *seed;  // (capacity): the cell at an electrode from which each cell was reached
	int32_t *slot;  // (capacity): index of a cell in the region + 1; 0: not in the region
	double *face_s; // (capacity x 6)
	double *to_electrode_s, *to_far_s, *diagonal_s; // (capacity)
	double *source, *vector[4];                     // (capacity)
} cau_current;

// Allocates arrays for as many cells as `bioheat` can have. Error: CAU_NO_MEMORY.
cau_status cau_current_create(cau_current *current, const cau_bioheat *bioheat, cau_arena *arena,
                              cau_error *error);

// Solves within reach_m of the electrodes. If tissue continues beyond and `grounded` is set, the
// potential falls there as far from a single electrode. If `grounded` is not set, no current leaves
// the region. Stops at a relative residual of `tolerance`, or after `most` iterations of conjugate
// gradients.
void cau_current_solve(cau_current *current, const cau_bioheat *bioheat, double reach_m,
                       bool grounded, double tolerance, int32_t most);

// Adds the heat of the current in each cell of the region to bioheat->power_w, W. `voltage` is the
// root mean square between the electrodes.
void cau_current_heat(const cau_current *current, cau_bioheat *bioheat, double voltage);

// ---- the generator
// Its current has a high frequency. Its power is constant over a range of loads, within its limits
// of voltage and current.

// A mode of a generator at a setting.
typedef struct cau_generator {
	double power_w;      // set power
	double peak_v;       // limit of the voltage, peak
	double current_a;    // limit of the current, root mean square
	double crest_factor; // peak voltage over its root mean square, at least sqrt(2)
} cau_generator;

typedef struct cau_output { // root mean squares
	double voltage_v, current_a, power_w;
} cau_output;

// Returns the output into a load of `conductance_s` (S, at least 0): the set power, or less at a
// limit.
cau_output cau_generator_into(const cau_generator *generator, double conductance_s);

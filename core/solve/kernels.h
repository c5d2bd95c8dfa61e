// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of a step. They are compiled once per precision and instruction set, and chosen
// at run time.
#pragma once

#include "constraint/elements.h"
#include "solve/newton.h"
#include "solve/sweep.h"
#include "solve/vectors.h"
#include "tissue/tissue.h"

// A share of the local step: slots [first, last) of one group, in whole batches, and the records
// that only this share writes.
typedef struct cau_local_work {
	int32_t number, kind, group, first, last; // kind: CAU_ELEMENT_*
	int32_t first_record, record_count;
} cau_local_work;

// The records of each vertex v, one for each share that has the vertex: record[first[v] .. first[v
// + 1]), ascending.
typedef struct cau_incidence {
	int32_t *first;  // (vertex_count + 1)
	int32_t *record; // CAU_RECORDS_AHEAD zeros follow, because records are prefetched
} cau_incidence;

enum { CAU_RECORDS_AHEAD = 32, CAU_ANDERSON_WINDOW = 5 };

// The history of an accelerated iteration: increments f = -A^-1 g, their gradients g, and the
// columns of the last iterations: df = f - f_last and h = step + df.
typedef struct cau_history {
	const cau_reals *increment, *gradient; // f, g
	cau_reals *last_increment, *last_gradient, *step;
	cau_reals *df[CAU_ANDERSON_WINDOW], *h[CAU_ANDERSON_WINDOW];
	int32_t count, newest; // number of columns; index of the newest
} cau_history;

typedef struct cau_kernels {
	const char *instruction_set;
	bool single;
	const cau_vectors *vectors; // vector operations of the same precision

	// Computes the records (N) and the energy (J) of the elements in `work`, at displacement u (m).
	void (*local)(const cau_elements *elements, const cau_local_work *work,
	              const cau_reals *displacement, bool diagonal);
	// Called before a solve, for viscous tissue: replaces the strain R by R + share (E - R)
	// (viscous_kernel.h).
	void (*take_strain)(const cau_elements *elements, const cau_local_work *work,
	                    const cau_reals *displacement, double share);
	// Called after a step: applies plastic flow. Returns the number of inverted tetrahedra.
	int32_t (*settle)(const cau_elements *elements, const cau_local_work *work,
	                  const cau_reals *displacement);
	// gradient[v] = sum of v's records, in their order, for v in [first, last)
	void (*sum)(const cau_elements *elements, const cau_incidence *incidence, int32_t first,
	            int32_t last, cau_reals *gradient);
	// The forward or backward sweep of one supernode, on the sweep's field.
	void (*forward)(const cau_sweep *sweep, int32_t supernode);
	void (*backward)(const cau_sweep *sweep, int32_t supernode);
	// Packs one supernode of the factor into the panels. Returns its least pivot. `part` (below
	// CAU_PACK_PARTS) is the index of the scratch: one thread at a time for each.
	double (*pack)(const cau_sweep *sweep, int32_t supernode, const cau_factor *factor,
	               const cau_sweep_panels *panels, int32_t part);
	// newton_factor factors Newton's H = L D L^T in place, and returns false if H is not positive
	// definite. newton_solve sets field = H^-1 field.
	bool (*newton_factor)(const cau_newton *newton);
	void (*newton_solve)(const cau_newton *newton);
	// Returns the dot product in double of n reals from `first` on, in a fixed order.
	double (*dot)(const cau_reals *a, const cau_reals *b, int64_t first, int64_t n);
	// increment[v] += sum of column[k][v] * load[k], in the order of the `count` columns, for v in
	// [first, last). A column has one real for each vertex. A load has x, y and z.
	void (*spread)(cau_reals *increment, const cau_reals *const *column, const double *load,
	               int32_t count, int32_t first, int32_t last);
	// y += s x over n reals
	void (*add_scaled)(cau_reals *y, double s, const cau_reals *x, int64_t n);
	// Anderson acceleration (anderson.c) over n reals from `first` on. add_column adds a column of
	// the last two iterations and finds its products with all columns. combine computes the step
	// from the weights.
	void (*add_column)(const cau_history *history, int64_t first, int64_t n, double *dot);
	void (*combine)(const cau_history *history, int64_t first, int64_t n, const double *weight);
} cau_kernels;

// Returns the best kernels that this processor runs. `ceiling` is the highest tier allowed:
// "baseline", "avx2", "avx512"; NULL: all.
const cau_kernels *cau_kernels_choose(bool single, const char *ceiling);

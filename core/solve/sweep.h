// SPDX-License-Identifier: GPL-3.0-or-later
// The global step's triangular solves (eq. 7), packed from CHOLMOD's factor L D L^T = P A P^T.
//
// Columns are grouped in supernodes; whole leaf subtrees of the elimination tree are merged into
// one dense block. With L_s the unit lower diagonal block of a supernode of c columns and L_r its
// rows below, the panel W = [L_s^-1; L_r L_s^-1] serves both sweeps as one dense product, for three
// right-hand sides:
//
//     forward   y_s = L_s^-1 b_s,  b_r -= L_r y_s          ->  [y_s; t] = W b_s, b_r -= t
//     backward  x_s = L_s^-T (D^-1 y_s - L_r^T x_r)        ->  x_s = W^T [D^-1 y_s; -x_r]
//
// W is kept twice: by columns for the forward sweep, by rows for the backward one, so that neither
// needs horizontal sums. Disjoint subtrees are tasks with accumulators of their own for the rows
// above them, added in task order: the result does not depend on how many threads run the tasks.
#pragma once

#include <stdint.h>

#include "base/memory.h"
#include "base/pages.h"
#include "base/pool.h"
#include "solve/factor.h"

enum {
	CAU_SWEEP_TASKS = 8,    // more leave more above them, for one thread
	CAU_NODE_COLUMNS = 128, // no supernode is wider
};

struct cau_kernels;

typedef struct cau_supernode {
	int32_t first, columns;    // its columns
	int32_t row, rows;         // its rows below: row_index[row .. row + rows), ascending
	int32_t inner_rows;        // of these, rows inside its task's subtree; the others are above
	int32_t task;              // or -1: above all tasks
	int32_t parent;            // supernode of the first row below, or -1
	int64_t forward, backward; // offsets of W in the panels, in reals
	int32_t padded_rows, padded_columns; // multiples of the lanes
} cau_supernode;

typedef struct cau_sweep {
	int single;
	const struct cau_kernels *kernels;
	int32_t n, supernode_count, row_count, top_count, task_count;
	cau_supernode *supernode;
	int32_t *
		row_index; // (row_count), permuted numbers; rows above a task as numbers among the top rows
	int32_t *row_global;  // (row_count), permuted numbers always
	int32_t *column_node; // (n): supernode of a column
	int32_t *top_column;  // (top_count): permuted number of each top row
	int32_t task_first[CAU_SWEEP_TASKS], task_last[CAU_SWEEP_TASKS]; // supernodes [first, last)
	int32_t *top_node; // supernodes above the tasks, ascending
	int32_t top_node_count;
	int32_t max_rows, max_columns; // padded, of a supernode
	int64_t max_dense;             // doubles that packing a supernode takes, see sweep_pack.c
	cau_pages pages;               // of the next three
	void *forward, *backward;      // real panels
	void *d_inverse;               // real (n)
	void *rhs;                     // real (3 x padded n): the vectors, permuted
	void *above;                   // real (task_count x 3 x padded top_count)
	int64_t panel_reals;
	int32_t padded_n, padded_top;
	double *scratch; // for packing one supernode, see sweep_pack.c
} cau_sweep;

// Lays the panels out for the factor's pattern and packs them. CAU_NO_MEMORY is the only failure;
// the caller finishes it, on failure too.
cau_status cau_sweep_create(cau_sweep *sweep, cau_arena *arena, const cau_factor *factor,
                            const struct cau_kernels *kernels, cau_error *error);
void cau_sweep_finish(cau_sweep *sweep);

// ---- sweep_pack.c: the factor's values in the panels
// A second set of panels of the same layout, for a factor that is being made in the background.
typedef struct cau_sweep_panels {
	cau_pages pages; // of the next three
	void *forward, *backward, *d_inverse;
} cau_sweep_panels;
cau_status cau_sweep_create_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                                   cau_error *error);
void cau_sweep_finish_panels(cau_sweep_panels *panels);
void cau_sweep_swap_panels(cau_sweep *sweep, cau_sweep_panels *panels);

// Packs supernodes from the factor's values: all, or those marked in touched (supernode_count
// bytes). Returns the least pivot among their columns. One thread at a time: there is one scratch.
double cau_sweep_pack(const cau_sweep *sweep, const cau_factor *factor, const uint8_t *touched);
void cau_sweep_pack_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                           const cau_factor *factor);

// Marks the supernodes on the path from column `column` to the root.
void cau_sweep_mark_path(const cau_sweep *sweep, int32_t column, uint8_t *touched);

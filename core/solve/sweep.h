// SPDX-License-Identifier: GPL-3.0-or-later
// The global step's triangular solves (eq. 7), packed from CHOLMOD's factor L D L^T = P A P^T.
//
// Columns are grouped in supernodes; whole leaf subtrees of the elimination tree are merged into
// one dense block. With L_s the unit lower diagonal block of a supernode of c columns and L_r its
// rows below, the panel W' = [I - L_s^-1; L_r L_s^-1] serves both sweeps as one dense product, for
// the three coordinates:
//
//     forward   y_s = L_s^-1 b_s,  b_r -= L_r y_s     ->  [b_s; b_r] -= W' b_s
//     backward  x_s = L_s^-T (D^-1 y_s - L_r^T x_r)   ->  x_s = z - W'^T [z; x_r],  z = D^-1 y_s
//
// W' is kept once, by columns, whose rows are lanes; in the backward sweep each column then sums
// its lanes up, which costs less than reading a second copy. Where precision is single and the
// panels are too large for a core's own cache, its entries are narrow: sixteen bits, whole steps of
// a scale that each column has, since what the sweeps cost then is reading them. Both read the same
// rounded W', so what they apply is symmetric and positive definite whatever the rounding, A^-1
// within 1e-4; the iteration takes increments by it, and each takes up the error of the last.
// Disjoint subtrees are tasks with sums of their own for the rows above them, added in task order:
// the result does not depend on how many threads run the tasks.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"
#include "base/pages.h"
#include "base/pool.h"
#include "solve/factor.h"
#include "solve/vectors.h"

enum {
	CAU_SWEEP_TASKS = 8,        // more leave more above them, for one thread
	CAU_NODE_COLUMNS = 128,     // no supernode is wider
	CAU_PACK_PARTS = 2,         // threads that renew supernodes together
	CAU_WHOLE_PANELS = 1 << 20, // bytes: a core's own cache; larger ones are narrow
};

struct cau_kernels;

typedef struct cau_supernode {
	int32_t first, columns; // its columns
	int32_t row, rows;      // its rows below: row_global[row .. row + rows), ascending
	int32_t place;          // of its places' lists: [place .. place + padded_rows)
	int32_t spare;          // a place that nobody reads, for padded rows
	int32_t task;           // or -1: above all tasks
	int32_t parent;         // supernode of the first row below, or -1
	int64_t panel;          // offset of W' in the panels, in entries
	int32_t padded_rows;    // a multiple of the lanes
} cau_supernode;

// The factor's values: those in use, or a second set of the same layout, for a factor that is being
// made in the background.
typedef struct cau_sweep_panels {
	cau_pages pages; // one allocation that holds panel, d_inverse and scale
	void *panel;     // reals, or narrow entries
	cau_reals *d_inverse, *scale;
} cau_sweep_panels;

struct cau_sweep {
	bool narrow;
	const struct cau_kernels *kernels;
	int32_t n, supernode_count, row_count, top_count, task_count;
	cau_supernode *supernode;
	int32_t *row_global; // (row_count), permuted numbers
	// (place_count): where a supernode's columns and rows stand in the field, in reals; what the
	// forward sweep adds to rows above its task goes to the task's sums
	int32_t *forward_place, *backward_place;
	int32_t place_count;
	int32_t *column_node; // (n): supernode of a column
	int32_t *top_column;  // (top_count): permuted number of each top row
	int32_t task_first[CAU_SWEEP_TASKS], task_last[CAU_SWEEP_TASKS]; // supernodes [first, last)
	int32_t *top_node; // supernodes above the tasks, ascending
	int32_t top_node_count;
	cau_pages pages;              // one allocation that holds panel, d_inverse and scale
	void *panel;                  // the panels: reals, or narrow entries
	cau_reals *d_inverse, *scale; // (padded_n): D^-1, and what a step in the column is
	// Four reals a place (x, y, z, 0): the vectors, permuted (padded_n), then each task's sums for
	// the rows above it and its spare place (padded_top + 1), then that of the top supernodes.
	cau_reals *field;
	int64_t panel_entries;
	int32_t padded_n, padded_top;
	int64_t max_dense;  // reals that packing a supernode takes
	cau_reals *dense;   // (CAU_PACK_PARTS x max_dense), for packing a supernode
	int32_t *row_place; // (CAU_PACK_PARTS x n): likewise
};

// Lays the panels out for the factor's pattern and packs them; those of single precision with more
// than `whole_panels` bytes are narrow. CAU_NO_MEMORY is the only failure;
// the caller finishes it, on failure too.
cau_status cau_sweep_create(cau_sweep *sweep, cau_arena *arena, const cau_factor *factor,
                            const struct cau_kernels *kernels, int64_t whole_panels,
                            cau_error *error);
void cau_sweep_finish(cau_sweep *sweep);

// The place of the task's first sum; of task_count: the last spare place.
int32_t cau_sweep_task_place(const cau_sweep *sweep, int32_t task);

// ---- sweep_pack.c: the factor's values in the panels
// Of an entry of the panels.
size_t cau_sweep_entry_bytes(const cau_sweep *sweep);

cau_status cau_sweep_create_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                                   cau_error *error);
void cau_sweep_finish_panels(cau_sweep_panels *panels);
void cau_sweep_swap_panels(cau_sweep *sweep, cau_sweep_panels *panels);

// Packs all supernodes from the factor's values. One thread at a time: they share the scratch.
void cau_sweep_pack(const cau_sweep *sweep, const cau_factor *factor);
void cau_sweep_pack_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                           const cau_factor *factor);
// Packs those marked in touched (supernode_count bytes), and takes the marks away. Returns the
// least pivot among their columns.
double cau_sweep_pack_touched(const cau_sweep *sweep, const cau_factor *factor, uint8_t *touched,
                              cau_pool *pool);

// Marks the supernodes on the path from column `column` to the root.
void cau_sweep_mark_path(const cau_sweep *sweep, int32_t column, uint8_t *touched);

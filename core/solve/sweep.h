// SPDX-License-Identifier: GPL-3.0-or-later
// The global step's triangular solves (eq. 7), packed from CHOLMOD's factor L D L^T = P A P^T.
//
// Columns are grouped in supernodes. Each whole leaf subtree of the elimination tree is merged into
// one dense block. L_s is the unit lower diagonal block of a supernode of c columns, and L_r has
// its rows below. The panel W' = [I - L_s^-1; L_r L_s^-1] serves both sweeps as one dense product,
// for the three coordinates:
//
//     forward   y_s = L_s^-1 b_s,  b_r -= L_r y_s     ->  [b_s; b_r] -= W' b_s
//     backward  x_s = L_s^-T (D^-1 y_s - L_r^T x_r)   ->  x_s = z - W'^T [z; x_r],  z = D^-1 y_s
//
// W' is stored once, by columns; rows are lanes. In the backward sweep each column then sums its
// lanes, which costs less than reading a second copy. The cost of the sweeps is reading W'. So if
// the precision is single and the panels are larger than a core's own cache, entries are narrow:
// sixteen-bit multiples of a scale for each column. Both sweeps read the same rounded W'. So the
// applied matrix is symmetric and positive definite whatever the rounding, and is A^-1 within 1e-4.
// The iteration uses it for increments only, and each increment corrects the error of the last.
//
// Disjoint subtrees are tasks. Each task has its own sums for the rows above the task. The tasks'
// sums are added in task order, so that the result does not depend on how many threads run the
// tasks.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"
#include "base/pool.h"
#include "solve/factor.h"
#include "solve/vectors.h"

enum {
	// most tasks; with more, more supernodes would be above all tasks and run on one thread
	CAU_SWEEP_TASKS = 8,
	CAU_NODE_COLUMNS = 128,     // most columns of a supernode
	CAU_PACK_PARTS = 2,         // most threads that pack supernodes at the same time
	CAU_WHOLE_PANELS = 1 << 20, // bytes: a core's own cache; larger panels have narrow entries
};

struct cau_kernels;

typedef struct cau_supernode {
	int32_t first, columns; // columns [first, first + columns) of L
	int32_t row, rows; // rows below the diagonal block: row_global[row .. row + rows), ascending
	int32_t place;  // start in forward_place and backward_place, which have padded_rows entries for
	                // this supernode
	int32_t spare;  // index in the field that is never read, for padded rows
	int32_t task;   // index of the task; -1: above all tasks
	int32_t parent; // supernode of the first row below, or -1
	int64_t panel;  // offset of W' in the panels, in entries
	int32_t padded_rows; // rows of the panel, a multiple of the lanes
} cau_supernode;

// The factor's values in packed form: the set in use, or a second set of the same layout for a
// factor that is computed in the background.
typedef struct cau_sweep_panels {
	cau_pages pages; // one allocation for panel, d_inverse and scale
	void *panel;     // the panels: reals, or narrow entries
	cau_reals *d_inverse, *scale;
} cau_sweep_panels;

struct cau_sweep {
	bool narrow;
	const struct cau_kernels *kernels;
	int32_t n, supernode_count, row_count, top_count, task_count;
	cau_supernode *supernode;
	int32_t *row_global; // (row_count): row numbers in the factor's order
	// (place_count): index in the field, in reals, of each supernode's columns and rows. The
	// forward sweep adds to the task's sums for rows above its task.
	int32_t *forward_place, *backward_place;
	int32_t place_count;
	int32_t *column_node; // (n): supernode of each column
	// (top_count): row number, in the factor's order, of each row above the tasks
	int32_t *top_column;
	int32_t task_first[CAU_SWEEP_TASKS], task_last[CAU_SWEEP_TASKS]; // supernodes [first, last)
	int32_t *top_node; // supernodes above the tasks, ascending
	int32_t top_node_count;
	cau_pages pages;              // one allocation for panel, d_inverse and scale
	void *panel;                  // the panels: reals, or narrow entries
	cau_reals *d_inverse, *scale; // (padded_n): D^-1; the unit of narrow entries in each column
	// Four reals for each entry (x, y, z, 0). First come the vectors in the factor's order
	// (padded_n). Then come each task's sums for the rows above it, and its spare entry (padded_top
	// + 1). The spare entry of the supernodes above the tasks is last.
	cau_reals *field;
	int64_t panel_entries;
	int32_t padded_n, padded_top;
	int64_t max_dense;  // reals of scratch to pack a supernode
	cau_reals *dense;   // (CAU_PACK_PARTS x max_dense): scratch to pack a supernode
	int32_t *row_place; // (CAU_PACK_PARTS x n): scratch to pack a supernode
};

// Lays out the panels for the factor's pattern and packs them. Panels of single precision with more
// than `whole_panels` bytes are narrow. CAU_NO_MEMORY is the only failure. The caller must call
// cau_sweep_finish, on failure too.
cau_status cau_sweep_create(cau_sweep *sweep, cau_arena *arena, const cau_factor *factor,
                            const struct cau_kernels *kernels, int64_t whole_panels,
                            cau_error *error);
void cau_sweep_finish(cau_sweep *sweep);

// Returns the field index of the first sum of a task. For `task` = task_count, returns the index of
// the last spare entry.
int32_t cau_sweep_task_place(const cau_sweep *sweep, int32_t task);

// ---- sweep_pack.c: the factor's values in the panels
// Returns the size of an entry of the panels.
size_t cau_sweep_entry_bytes(const cau_sweep *sweep);

cau_status cau_sweep_create_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                                   cau_error *error);
void cau_sweep_finish_panels(cau_sweep_panels *panels);
void cau_sweep_swap_panels(cau_sweep *sweep, cau_sweep_panels *panels);

// Packs all supernodes from the factor's values. Only one thread at a time, because they share the
// scratch.
void cau_sweep_pack(const cau_sweep *sweep, const cau_factor *factor);
void cau_sweep_pack_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                           const cau_factor *factor);
// Packs the supernodes that are marked in `touched` (supernode_count bytes), and clears the marks.
// Returns the least pivot of their columns.
double cau_sweep_pack_touched(const cau_sweep *sweep, const cau_factor *factor, uint8_t *touched,
                              cau_pool *pool);

// Marks the supernodes on the path from column `column` to the root.
void cau_sweep_mark_path(const cau_sweep *sweep, int32_t column, uint8_t *touched);

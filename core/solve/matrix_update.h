// SPDX-License-Identifier: GPL-3.0-or-later
// Keeping the factor in step with cuts (section 7.2).
//
// A removed element stays in the factor without force until it is taken out: a few a tick by exact
// downdates; when more wait than that can serve, a whole new factor is made on another thread and
// swapped in a fixed number of ticks later, so that every replay swaps at the same tick. The new
// factor is made in the old one's place, since nothing but its order is read meanwhile: the steps
// go on with the packed one. Its panels are there from the start of the making to just after the
// swap.
#pragma once

#include "base/background.h"
#include "solve/solver.h"

enum {
	CAU_LEAST_UPDATES = 2, // of rank 8 in a tick, while anything waits
	CAU_MOST_UPDATES = 6,
	CAU_WAITING_TICKS = 2,        // what has waited for so long is taken out
	CAU_DOWNDATES_AT_MOST = 2000, // elements, then a canonical factorisation
};

typedef struct cau_waiting {
	int32_t kind, element;
	uint64_t tick; // the first without it
} cau_waiting;

typedef struct cau_operation { // an element taken out of the factor
	int32_t kind, element;
	int32_t group; // elements of one update share it
} cau_operation;

typedef struct cau_matrix_update {
	int32_t waiting_count, waiting_capacity;
	cau_waiting *waiting;    // removed, still in the factor, in order of removal
	int32_t operation_count; // elements downdated since the last canonical factorisation
	int32_t group_count;
	cau_operation *operation;              // (CAU_DOWNDATES_AT_MOST): which, in order
	uint8_t *canonical[CAU_ELEMENT_KINDS]; // alive at the last canonical factorisation
	// The factor in the making.
	bool making;
	uint64_t swap_tick;
	int32_t waiting_at_start; // the first of `waiting` that it takes care of
	uint8_t *next_canonical[CAU_ELEMENT_KINDS];
	cau_background *background;
	cau_sweep_panels next_panels; // empty if there was no memory: packed at the swap then
	cau_status next_status;
	// What is taken out in this tick.
	int updates_due;
	int32_t done; // elements
	cau_status due_status;
	cau_error due_error;
	uint8_t *touched; // (supernode_count)
	double least_pivot_bound;
	int32_t refactorisations;
	uint64_t longest_wait; // ticks
	cau_step_solver *solver;
} cau_matrix_update;

cau_status cau_matrix_update_create(cau_matrix_update *update, cau_step_solver *solver,
                                    const cau_alive *alive, cau_arena *arena, cau_error *error);
// Gives the background thread up for one that the caller is the parent of.
cau_status cau_matrix_update_adopt(cau_matrix_update *update, cau_error *error);
void cau_matrix_update_finish(cau_matrix_update *update);

// Notes a removal; `tick` is the first whose local step is without the element.
void cau_matrix_update_remove(cau_matrix_update *update, int kind, int32_t element, uint64_t tick);

// Once a tick, before its first global step, in three: _begin starts or swaps factors, or chooses
// what is taken out; _take_out (of a cau_matrix_update) does the downdates, and may run beside a
// local step; _end packs what they changed. CAU_NUMERICAL if a factorisation fails.
cau_status cau_matrix_update_begin(cau_matrix_update *update, const cau_alive *alive, uint64_t tick,
                                   cau_error *error);
void cau_matrix_update_take_out(void *update);
cau_status cau_matrix_update_end(cau_matrix_update *update, const cau_alive *alive, uint64_t tick,
                                 cau_error *error);

// Takes as many elements of `list` out of the factor as one update of rank 8 holds; *taken of them.
// The packed factor is refreshed by cau_matrix_update_pack, which returns the least pivot of what
// it packed.
cau_status cau_matrix_update_downdate(cau_matrix_update *update, const cau_waiting *list,
                                      int32_t count, int32_t *taken, cau_error *error);
double cau_matrix_update_pack(cau_matrix_update *update);

// Starts making the factor of next_canonical, to be swapped in at swap_tick.
void cau_matrix_update_start(cau_matrix_update *update, uint64_t swap_tick);

// Waits for the factor in the making, which is taken at its tick as ever: before the whole is
// copied.
void cau_matrix_update_await(const cau_matrix_update *update);

// Waits for the factor in the making and forgets it: before what it reads (materials, pins, the
// live elements it stands for) changes. The factor must be made anew then.
void cau_matrix_update_stop(cau_matrix_update *update);

// Factors anew at once (materials or pins changed, restore): nothing waits afterwards.
cau_status cau_matrix_update_refactor(cau_matrix_update *update, const cau_alive *alive,
                                      cau_error *error);

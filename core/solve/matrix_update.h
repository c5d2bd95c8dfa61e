// SPDX-License-Identifier: GPL-3.0-or-later
// Updates the factor after cuts (section 7.2).
//
// A removed element stays in the factor, without force, until its part is downdated. Each tick
// downdates a few elements exactly. If more elements wait than downdates can handle, another thread
// computes a whole new factor. The new factor comes into use a fixed number of ticks later, so that
// every replay swaps at the same tick. The new factor is computed in the memory of the old factor.
// Meanwhile the steps use the packed panels, and read only the order of the factor. The panels of
// the new factor exist from the start of its computation to just after the swap.
#pragma once

#include "base/pool.h"
#include "solve/solver.h"

enum {
	CAU_LEAST_UPDATES = 2, // least updates of rank 8 in a tick while an element waits
	CAU_MOST_UPDATES = 6,
	// ticks of waiting after which an element is downdated as soon as possible
	CAU_WAITING_TICKS = 2,
	// downdated elements after which a canonical factorisation follows
	CAU_DOWNDATES_AT_MOST = 2000,
};

typedef struct cau_waiting {
	int32_t kind, element;
	uint64_t tick; // the first tick without the element
} cau_waiting;

typedef struct cau_operation { // an element that was downdated
	int32_t kind, element;
	int32_t group; // number that elements of one update have in common
} cau_operation;

typedef struct cau_matrix_update {
	int32_t waiting_count, waiting_capacity;
	cau_waiting *waiting;    // removed elements that the factor still contains, in order of removal
	int32_t operation_count; // elements downdated since the last canonical factorisation
	int32_t group_count;
	cau_operation *operation; // (CAU_DOWNDATES_AT_MOST): the elements downdated, in order
	uint8_t *canonical[CAU_ELEMENT_KINDS]; // elements that were alive at the last canonical
	                                       // factorisation
	// The factor that is being computed in the background.
	bool making;
	uint64_t swap_tick;
	int32_t waiting_at_start; // number of waiting elements that the new factor no longer contains
	uint8_t *next_canonical[CAU_ELEMENT_KINDS];
	cau_background *background;
	cau_sweep_panels next_panels; // panels for the new factor; empty if there was no memory: the
	                              // swap then packs the old ones
	cau_status next_status;
	// The downdates of this tick.
	int updates_due;
	int32_t done; // elements downdated in this tick
	cau_status due_status;
	cau_error due_error;
	uint8_t *touched; // (supernode_count): 1 if downdates changed the supernode
	double least_pivot_bound;
	int32_t refactorisations;
	uint64_t longest_wait; // longest wait of a removed element for its downdate, ticks
	cau_step_solver *solver;
} cau_matrix_update;

cau_status cau_matrix_update_create(cau_matrix_update *update, cau_step_solver *solver,
                                    const cau_alive *alive, cau_arena *arena, cau_error *error);
// Replaces the background thread by one that the calling thread creates.
cau_status cau_matrix_update_adopt(cau_matrix_update *update, cau_error *error);
void cau_matrix_update_finish(cau_matrix_update *update);

// Notes that an element was removed. `tick` is the first tick whose local step is without the
// element.
void cau_matrix_update_remove(cau_matrix_update *update, int kind, int32_t element, uint64_t tick);

// Called once a tick, before its first global step, in three parts. _begin starts or swaps factors,
// or chooses how much is downdated. _take_out (its argument is a cau_matrix_update) does the
// downdates; it may run beside a local step. _end packs the changed supernodes. CAU_NUMERICAL if a
// factorisation fails.
cau_status cau_matrix_update_begin(cau_matrix_update *update, const cau_alive *alive, uint64_t tick,
                                   cau_error *error);
void cau_matrix_update_take_out(void *update);
cau_status cau_matrix_update_end(cau_matrix_update *update, const cau_alive *alive, uint64_t tick,
                                 cau_error *error);

// Downdates as many elements of `list` as one update of rank 8 holds; *taken is their number.
// cau_matrix_update_pack then refreshes the packed factor. It returns the least pivot of the
// supernodes that it packed.
cau_status cau_matrix_update_downdate(cau_matrix_update *update, const cau_waiting *list,
                                      int32_t count, int32_t *taken, cau_error *error);
double cau_matrix_update_pack(cau_matrix_update *update);

// Starts computing the factor of the elements in next_canonical. The swap is at swap_tick.
void cau_matrix_update_start(cau_matrix_update *update, uint64_t swap_tick);

// Waits until the factor in the background is computed; the swap stays at its tick. Called before
// the whole state is copied.
void cau_matrix_update_await(const cau_matrix_update *update);

// Waits until the factor in the background is computed, and discards it. Called before its input
// changes: materials, pins or the set of live elements. The factor must then be computed again.
void cau_matrix_update_stop(cau_matrix_update *update);

// Computes the factor at once, after a change of materials or pins, or after a restore. No element
// waits afterwards.
cau_status cau_matrix_update_refactor(cau_matrix_update *update, const cau_alive *alive,
                                      cau_error *error);

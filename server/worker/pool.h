// SPDX-License-Identifier: GPL-3.0-or-later
// Worker threads that run tasks: one task on one worker at a time, of the tasks that are due the
// one with the earliest deadline first. A task that is not due costs nothing.
//
// A slice is to end within CAU_SLICE_MOST_S, but what cannot be divided may take longer. Tasks of
// which that is known never hold the last worker while others are there; where there is one worker
// only, no two slices of such tasks follow each other while others are due.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_worker_pool cau_worker_pool;

// When a task wants to run next, on the monotonic clock.
typedef struct cau_due {
	double due_s;      // not before; INFINITY: when woken
	double deadline_s; // orders the tasks that are due
	double piece_s;    // the longest piece of work that its next slice may hold, as far as is known
} cau_due;

#define CAU_SLICE_MOST_S 0.02

typedef struct cau_task {
	cau_due (*run)(struct cau_task *task); // one slice of work, some milliseconds
	double undivided_s; // set in a slice: processor time of what in it cannot be divided
	// The pool's own; of `next` the piece_s is that of the first slice, set before it is added.
	cau_due next;
	bool running, woken, leaving;
	int32_t index;
	double ended_s; // the last slice
} cau_task;

// `task_capacity` bounds the tasks at once. Threads run at `nice` (0 to 19).
cau_status cau_worker_pool_create(cau_worker_pool **pool, int32_t threads, int32_t task_capacity,
                                  int32_t nice, cau_error *error);
// Ends after each worker's present slice. Tasks are the caller's. Takes NULL.
void cau_worker_pool_destroy(cau_worker_pool *pool);

// Adds a task, due at once. False if the pool is full.
bool cau_worker_pool_add(cau_worker_pool *pool, cau_task *task);
// Takes a task out and waits until no worker is inside it. Not to be called from its own slice.
void cau_worker_pool_remove(cau_worker_pool *pool, cau_task *task);
// Makes a task due now; if it is running, it runs once more. From any thread.
void cau_worker_pool_wake(cau_worker_pool *pool, cau_task *task);
// Processor time of the longest slice so far, s, without what in it cannot be divided. Processor
// time: others that use the machine do not make a slice longer.
double cau_worker_pool_longest_s(cau_worker_pool *pool);
// Tasks that are running or due.
int32_t cau_worker_pool_busy(cau_worker_pool *pool);

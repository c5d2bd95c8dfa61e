// SPDX-License-Identifier: GPL-3.0-or-later
// Worker threads that run tasks. A task runs on one worker at a time. Among the tasks that are due,
// the one with the earliest deadline runs first. A task that is not due costs nothing.
//
// A slice should end within CAU_SLICE_MOST_S, but an undivided piece of work may take longer. A
// task with such pieces is a long task. Long tasks never occupy the last worker while there are
// other tasks. With only one worker, two slices of long tasks never follow each other while other
// tasks are due.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_worker_pool cau_worker_pool;

// When a task must run next, on the monotonic clock.
typedef struct cau_due {
	double due_s;      // earliest time; INFINITY: only when woken
	double deadline_s; // the task with the earliest deadline runs first
	double piece_s;    // longest undivided piece of work in the next slice, as far as is known
} cau_due;

#define CAU_SLICE_MOST_S 0.02

typedef struct cau_task {
	cau_due (*run)(struct cau_task *task); // runs one slice of work, some milliseconds
	double undivided_s;                    // set in a slice: processor time of its undivided piece
	// The members below are the pool's. But set next.piece_s, for the first slice, before the task
	// is added.
	cau_due next;
	bool running, woken, leaving;
	int32_t index;
	double ended_s; // end of the last slice
} cau_task;

// Makes a pool of at most `task_capacity` tasks at a time. Its threads run at `nice` (0 to 19).
cau_status cau_worker_pool_create(cau_worker_pool **pool, int32_t threads, int32_t task_capacity,
                                  int32_t nice, cau_error *error);
// Ends each worker after its present slice. The tasks stay the caller's. `pool` may be NULL.
void cau_worker_pool_destroy(cau_worker_pool *pool);

// Adds a task, due at once. Returns false if the pool is full.
bool cau_worker_pool_add(cau_worker_pool *pool, cau_task *task);
// Removes a task and waits until no worker runs it. Must not be called from the task's own slice.
void cau_worker_pool_remove(cau_worker_pool *pool, cau_task *task);
// Makes a task due now. If it is running, it runs once more. Any thread may call it.
void cau_worker_pool_wake(cau_worker_pool *pool, cau_task *task);
// Returns the processor time of the longest slice so far, s, without its undivided piece. It is
// processor time, so other programs on the machine do not lengthen it.
double cau_worker_pool_longest_s(cau_worker_pool *pool);
// Returns the number of tasks that are running or due.
int32_t cau_worker_pool_busy(cau_worker_pool *pool);

// ---- priorities ---------------------------------------------------------------------------------
// Priorities of the daemon's threads, for times when the processors are fully used: network and
// watchdog first, workers after them, and the builder last.

enum {
	// takes effect if the system permits it: CAP_SYS_NICE, or LimitNICE of the service
	CAU_NICE_FIRST = -5,
	CAU_NICE_LAST = 5,
	// With this value the builder gets the time that workers leave, or a third of a worker's share.
	// At 15, building a session that needs 2.5 s took 79 s while two other programs ran.
	CAU_NICE_BUILDER = 10,
};

// Sets the priority of the calling thread. It stays if the system does not permit the change.
void cau_thread_set_nice(int nice);

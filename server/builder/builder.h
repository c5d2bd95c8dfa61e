// SPDX-License-Identifier: GPL-3.0-or-later
// Runs work that takes long, so that no session's steps wait for it: builds sessions, restores
// states from the store, and makes files. The threads run at a low priority, in processor time that
// workers leave.
//
// One thread takes only short jobs, so that these never wait for large tissue, whose stages
// (CHOLMOD, METIS) cannot be interrupted. The other threads take long jobs, and short ones if there
// is not a long one. So a daemon that starts builds several large sessions at once, one on each of
// these other threads.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_builder cau_builder;

typedef struct cau_job {
	void (*run)(struct cau_job *job); // runs the whole job, on a builder's thread; frees the job
	// called instead of run if the builder stops first; frees the job
	void (*drop)(struct cau_job *job);
	double expected_s; // about how long the job takes; orders the jobs
	// The members below are the builder's:
	struct cau_job *next;
	double rank;
} cau_job;

// Jobs that are expected to take longer than this, s, are long.
#define CAU_BUILDER_SHORT_S 0.5

enum { CAU_BUILDER_THREADS_MOST = 16 };

// Makes a builder with one thread for short jobs and `threads` threads (1 to
// CAU_BUILDER_THREADS_MOST) for jobs of any length, at `nice` (0 to 19). Tools show the threads
// under `name`, which is borrowed and has at most 15 bytes.
cau_status cau_builder_create(cau_builder **builder, const char *name, int32_t threads, int nice,
                              cau_error *error);
// Queues a job and takes it. After cau_builder_stop the job is dropped at once. Any thread may call
// it.
void cau_builder_submit(cau_builder *builder, cau_job *job);
// Drops the waiting jobs, and returns when the running ones have ended.
void cau_builder_stop(cau_builder *builder);
// Frees the builder, after cau_builder_stop and the last submit. `builder` may be NULL.
void cau_builder_destroy(cau_builder *builder);
// True once cau_builder_stop has been called. A long job checks this from time to time.
bool cau_builder_is_stopping(cau_builder *builder);
// Returns the number of waiting and running jobs.
int cau_builder_busy(cau_builder *builder);

// ---- the order of jobs --------------------------------------------------------------------------
// The order of the builder's jobs: the shortest goes first, but every job gets its turn. A later
// job overtakes a job only if it comes within CAU_JOB_PATIENCE times the earlier job's length.

enum { CAU_JOB_PATIENCE = 4 };

typedef struct cau_job_queue {
	cau_job *first; // ordered by rank
	int count;
} cau_job_queue;

void cau_job_queue_put(cau_job_queue *queue, cau_job *job, double now_s);
cau_job *cau_job_queue_take(cau_job_queue *queue); // NULL if the queue is empty

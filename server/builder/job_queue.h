// SPDX-License-Identifier: GPL-3.0-or-later
// The order of the builder's jobs: the shortest goes first, but every job gets its turn. A later
// job overtakes a job only if it comes within CAU_JOB_PATIENCE times the earlier job's length.
#pragma once

#include "builder/builder.h"

enum { CAU_JOB_PATIENCE = 4 };

typedef struct cau_job_queue {
	cau_job *first; // ordered by rank
	int count;
} cau_job_queue;

void cau_job_queue_put(cau_job_queue *queue, cau_job *job, double now_s);
cau_job *cau_job_queue_take(cau_job_queue *queue); // NULL if the queue is empty

// SPDX-License-Identifier: GPL-3.0-or-later
// Work that takes long and that no session's pace may wait for: sessions are built here, states
// read back from the store, files made. Done at a low priority, so that it gets what workers
// leave.
//
// One thread takes short jobs alone, so that these never stand behind large tissue, whose stages
// (CHOLMOD, METIS) nobody can interrupt. The others take long jobs, and short ones while there is
// no long one: a daemon that starts builds as many of its sessions at once.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_builder cau_builder;

typedef struct cau_job {
	void (*run)(struct cau_job *job);  // on a builder's thread, whole; the job is its own to free
	void (*drop)(struct cau_job *job); // instead, if the builder ends first; likewise
	double expected_s;                 // about how long it takes; orders the jobs
	// The builder's own:
	struct cau_job *next;
	double rank;
} cau_job;

// Jobs expected to last longer than this are long, s.
#define CAU_BUILDER_SHORT_S 0.5

enum { CAU_BUILDER_THREADS_MOST = 16 };

// With so many threads for jobs of any length (1 to CAU_BUILDER_THREADS_MOST), and the one for
// short ones, at `nice` (0 to 19). The name is what tools show of them: at most 15 bytes, kept.
cau_status cau_builder_create(cau_builder **builder, const char *name, int32_t threads, int nice,
                              cau_error *error);
// From any thread; takes the job. After cau_builder_stop it is dropped on the spot.
void cau_builder_submit(cau_builder *builder, cau_job *job);
// Drops what waits, and returns when the jobs under way have ended.
void cau_builder_stop(cau_builder *builder);
// After cau_builder_stop, when nobody submits any more. Takes NULL.
void cau_builder_destroy(cau_builder *builder);
// Whether cau_builder_stop has been called: what a long job asks now and then.
bool cau_builder_is_stopping(cau_builder *builder);
// Jobs that wait or are under way.
int cau_builder_busy(cau_builder *builder);

// SPDX-License-Identifier: GPL-3.0-or-later
// Threads: a pool that shares out the parts of a loop, and a thread in the background for one job.
#pragma once

#include <stdint.h>

// ---- the pool
// A few threads that run the parts of one loop. Parts are numbered, and a part's result never
// depends on the number of threads.
typedef struct cau_pool cau_pool;

enum { CAU_POOL_PARTS = 65535 }; // most parts of one loop

// Creates a pool in which `thread_count` threads run each loop. The caller's thread is one of these
// threads, so a count of 1 starts no thread. Returns NULL if there is no memory.
cau_pool *cau_pool_create(int32_t thread_count);
void cau_pool_destroy(cau_pool *pool); // accepts NULL
int32_t cau_pool_thread_count(const cau_pool *pool);

// Runs part(context, i) once for every i in [0, part_count), and returns when all parts are done.
// part_count is at most CAU_POOL_PARTS. Writes of one loop are visible to the next. Allocates no
// memory.
void cau_pool_run(cau_pool *pool, int32_t part_count, void (*part)(void *context, int32_t index),
                  void *context);

// ---- a thread in the background
// It runs one job at a time.
typedef struct cau_background cau_background;

cau_background *cau_background_create(void);             // NULL: there is no memory or no thread
void cau_background_destroy(cau_background *background); // waits for the job; accepts NULL

// Starts job(context). The previous job must have been waited for.
void cau_background_start(cau_background *background, void (*job)(void *context), void *context);

// Waits until the job is done; returns at once if there is none. The job's writes are visible
// afterwards.
void cau_background_wait(cau_background *background);

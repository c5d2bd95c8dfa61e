// SPDX-License-Identifier: GPL-3.0-or-later
// A few threads that run the parts of one loop. Parts are numbered, so what a part computes never
// depends on how many threads there are.
#pragma once

#include <stdint.h>

typedef struct cau_pool cau_pool;

enum { CAU_POOL_PARTS = 65535 }; // of one loop, at most

// `thread_count` threads run each loop, the caller's among them (so 1 starts none). NULL: no
// memory.
cau_pool *cau_pool_create(int32_t thread_count);
void cau_pool_destroy(cau_pool *pool); // takes NULL
int32_t cau_pool_thread_count(const cau_pool *pool);

// Runs part(context, i) for every i in [0, part_count), part_count at most CAU_POOL_PARTS, each
// once, and returns when all are done. Parts are claimed in order; writes of one loop are visible
// to the next. Allocates nothing.
void cau_pool_run(cau_pool *pool, int32_t part_count, void (*part)(void *context, int32_t index),
                  void *context);

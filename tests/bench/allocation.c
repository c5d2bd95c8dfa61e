// SPDX-License-Identifier: GPL-3.0-or-later
// Counts the allocations of the whole program and its libraries, by replacing glibc's functions.
#include <errno.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "bench/bench.h"

static _Atomic uint64_t calls;

uint64_t bench_allocations(void)
{
	return atomic_load(&calls);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

void *malloc(size_t size)
{
	atomic_fetch_add(&calls, 1);
	return __libc_malloc(size);
}
void *calloc(size_t count, size_t size)
{
	atomic_fetch_add(&calls, 1);
	return __libc_calloc(count, size);
}
void *realloc(void *old, size_t size)
{
	atomic_fetch_add(&calls, 1);
	return __libc_realloc(old, size);
}
void *aligned_alloc(size_t alignment, size_t size)
{
	atomic_fetch_add(&calls, 1);
	return __libc_memalign(alignment, size);
}
#endif

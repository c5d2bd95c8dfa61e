// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

enum { ALIGNMENT = 64 };

struct cau_arena_block {
	struct cau_arena_block *next;
	char padding[ALIGNMENT - sizeof(void *)];
};

void *cau_arena_array(cau_arena *arena, size_t count, size_t size)
{
	CAU_ASSERT(size > 0, "%zu elements of no size", count);
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 2)
		return NULL;
	size_t total =
		sizeof(struct cau_arena_block) + (bytes + 2 * ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
	struct cau_arena_block *block = aligned_alloc(ALIGNMENT, total);
	if (!block)
		return NULL;
	memset(block, 0, total);
	block->next = arena->blocks;
	arena->blocks = block;
	arena->byte_count += total;
	return block + 1;
}

void *cau_arena_copy(cau_arena *arena, const void *source, size_t count, size_t size)
{
	CAU_ASSERT(source || !count, "%zu elements of nothing", count);
	void *copy = cau_arena_array(arena, count, size);
	if (copy && count)
		memcpy(copy, source, count * size);
	return copy;
}

void cau_arena_finish(cau_arena *arena)
{
	while (arena->blocks) {
		CAU_ASSERT(arena->byte_count > 0, "%zu bytes handed out, and there are blocks",
		           arena->byte_count);
		struct cau_arena_block *next = arena->blocks->next;
		free(arena->blocks);
		arena->blocks = next;
	}
	arena->byte_count = 0;
}

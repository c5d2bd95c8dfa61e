// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"

#include <string.h>

#include "cautery/assert.h"

#ifdef __has_feature
#define CLANG_SANITIZES __has_feature(address_sanitizer)
#else
#define CLANG_SANITIZES 0
#endif
#if defined(__SANITIZE_ADDRESS__) || CLANG_SANITIZES
#include <sanitizer/asan_interface.h>
#define HIDE(start, bytes) ASAN_POISON_MEMORY_REGION(start, bytes)
#define SHOW(start, bytes) ASAN_UNPOISON_MEMORY_REGION(start, bytes)
// bytes between two arrays, by which the sanitizer detects accesses beyond an array
enum { GAP = 64 };
#else
#define HIDE(start, bytes) ((void)(start), (void)(bytes))
#define SHOW(start, bytes) ((void)(start), (void)(bytes))
enum { GAP = 0 };
#endif

enum {
	ALIGNMENT = 64,
	PAGE = 4096,
	LEAST_BLOCK = 64 << 10,
	MOST_BLOCK = 1 << 20, // larger arrays have a block of their own
};

// A block's header, at the start of its pages.
struct cau_arena_block {
	struct cau_arena_block *next;
	cau_pages pages;
	size_t used; // bytes used so far, from the start of the pages
	char padding[ALIGNMENT - sizeof(void *) - sizeof(cau_pages) - sizeof(size_t)];
};

static struct cau_arena_block *make_block(size_t least)
{
	cau_pages pages;
	size_t bytes = (sizeof(struct cau_arena_block) + least + PAGE - 1) / PAGE * PAGE;
	if (!cau_pages_take(&pages, bytes))
		return NULL;
	struct cau_arena_block *block = pages.start;
	*block = (struct cau_arena_block){.pages = pages, .used = sizeof *block};
	HIDE(block + 1, bytes - sizeof *block);
	return block;
}

// Returns the size of a new block. Blocks grow with their arena, so that a large arena has few
// blocks, with long runs of equal pages.
static size_t next_block_bytes(const cau_arena *arena)
{
	size_t bytes = arena->byte_count / 4;
	bytes = bytes < LEAST_BLOCK ? LEAST_BLOCK : bytes > MOST_BLOCK ? MOST_BLOCK : bytes;
	return bytes - sizeof(struct cau_arena_block);
}

static bool has_room(const struct cau_arena_block *block, size_t total)
{
	return total <= block->pages.byte_count - block->used;
}

// Returns a block with `total` free bytes; it allocates a block if none has them. NULL if there is
// no memory.
static struct cau_arena_block *block_for(cau_arena *arena, size_t total)
{
	for (struct cau_arena_block *b = arena->blocks; b; b = b->next)
		if (has_room(b, total))
			return b;
	size_t usual = next_block_bytes(arena);
	struct cau_arena_block *made = make_block(total > usual ? total : usual);
	if (!made)
		return NULL;
	made->next = arena->blocks;
	arena->blocks = made;
	return made;
}

void *cau_arena_array(cau_arena *arena, size_t count, size_t size)
{
	CAU_ASSERT(size > 0, "%zu elements of no size", count);
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 2)
		return NULL;
	size_t padded = (bytes + 2 * ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT, total = padded + GAP;
	struct cau_arena_block *block = block_for(arena, total);
	if (!block)
		return NULL;
	char *array = (char *)block->pages.start + block->used;
	SHOW(array, padded);
	block->used += total;
	arena->byte_count += total;
	return array;
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
		cau_pages pages = arena->blocks->pages;
		SHOW(pages.start, pages.byte_count);
		cau_pages_give_back(&pages);
		arena->blocks = next;
	}
	arena->byte_count = 0;
}

int32_t cau_arena_pages(const cau_arena *arena, cau_pages *pages, int32_t most)
{
	int32_t count = 0;
	for (const struct cau_arena_block *b = arena->blocks; b && count < most; b = b->next)
		pages[count++] = b->pages;
	return count;
}

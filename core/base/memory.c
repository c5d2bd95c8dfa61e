// SPDX-License-Identifier: GPL-3.0-or-later
// Arenas, and a heap whose large pieces are whole pages.
#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

// ---- arenas
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

// ---- a heap
enum { LEAST_LARGE = 64 << 10 };

// Header before each piece. Its size keeps the piece aligned as malloc does.
typedef struct head {
	cau_pages pages; // empty if the piece was allocated by malloc
	size_t bytes;    // size of the piece
	size_t unused;
} head;

static head *head_of(const void *memory)
{
	return (head *)(uintptr_t)memory - 1;
}

static void *take(size_t bytes, bool zeroed)
{
	if (bytes > SIZE_MAX / 2)
		return NULL;
	cau_pages pages = {0};
	head *made;
	if (bytes >= LEAST_LARGE)
		made = cau_pages_take(&pages, sizeof *made + bytes) ? pages.start : NULL;
	else
		made = zeroed ? calloc(1, sizeof *made + bytes) : malloc(sizeof *made + bytes);
	if (!made)
		return NULL;
	*made = (head){.pages = pages, .bytes = bytes};
	return made + 1;
}

void *cau_large_malloc(size_t bytes)
{
	return take(bytes, false);
}

void *cau_large_calloc(size_t count, size_t size)
{
	size_t bytes;
	return __builtin_mul_overflow(count, size, &bytes) ? NULL : take(bytes, true);
}

void *cau_large_realloc(void *memory, size_t bytes)
{
	void *moved = take(bytes, false);
	if (!moved || !memory)
		return moved;
	size_t before = head_of(memory)->bytes;
	memcpy(moved, memory, before < bytes ? before : bytes);
	cau_large_free(memory);
	return moved;
}

void cau_large_free(void *memory)
{
	if (!memory)
		return;
	cau_pages pages = head_of(memory)->pages;
	if (pages.start)
		cau_pages_give_back(&pages);
	else
		free(head_of(memory));
}

cau_pages cau_large_pages(const void *memory)
{
	return memory ? head_of(memory)->pages : (cau_pages){0};
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/large.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

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

// SPDX-License-Identifier: GPL-3.0-or-later
// Arenas: all arrays of a session come from one, so that ending a session is one call. They lie in
// whole pages, which sessions of equal tissue may share (base/image.h).
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "base/pages.h"

typedef struct cau_arena {
	struct cau_arena_block *blocks; // the newest first
	size_t byte_count;              // handed out so far
} cau_arena;

// A zeroed array of `count` elements of `size` bytes, aligned to 64 bytes and padded by 64; NULL
// when memory ran out or count * size overflows. count 0 gives a valid pointer. Freed by
// cau_arena_finish.
void *cau_arena_array(cau_arena *arena, size_t count, size_t size);

// Copy of `count` elements of `size` bytes, in an array like that of cau_arena_array.
void *cau_arena_copy(cau_arena *arena, const void *source, size_t count, size_t size);

void cau_arena_finish(cau_arena *arena);

// Writes the blocks that the arrays lie in, the newest first, up to `most`; returns how many.
// Arenas that were asked for the same in the same order have blocks of the same sizes. Borrowed.
int32_t cau_arena_pages(const cau_arena *arena, cau_pages *pages, int32_t most);

// SPDX-License-Identifier: GPL-3.0-or-later
// Arenas. All arrays of a session come from one arena, so that one call frees them. The arrays are
// in whole pages, which sessions of equal tissue may share (base/image.h).
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "base/pages.h"

typedef struct cau_arena {
	struct cau_arena_block *blocks; // newest first
	size_t byte_count;              // bytes allocated so far
} cau_arena;

// Returns a zeroed array of `count` elements of `size` bytes, aligned to 64 bytes and padded by 64.
// Returns NULL if there is no memory or count * size overflows. A count of 0 gives a valid pointer.
// cau_arena_finish frees the array.
void *cau_arena_array(cau_arena *arena, size_t count, size_t size);

// Copies `count` elements of `size` bytes to an array as cau_arena_array makes it. NULL if there is
// no memory.
void *cau_arena_copy(cau_arena *arena, const void *source, size_t count, size_t size);

void cau_arena_finish(cau_arena *arena);

// Writes the pages of the arena's blocks, newest first, at most `most`. Returns their number.
// Arenas with the same allocations in the same order have blocks of the same sizes. The arena still
// owns the pages.
int32_t cau_arena_pages(const cau_arena *arena, cau_pages *pages, int32_t most);

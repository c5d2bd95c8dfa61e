// SPDX-License-Identifier: GPL-3.0-or-later
// Arenas: all arrays of a session come from one, so that ending a session is one call.
#pragma once

#include <stddef.h>
#include <stdint.h>

typedef struct cau_arena {
	struct cau_arena_block *blocks;
	size_t byte_count; // handed out so far
} cau_arena;

// A zeroed array of `count` elements of `size` bytes, aligned to 64 bytes and padded by 64; NULL
// when memory ran out or count * size overflows. count 0 gives a valid pointer. Freed by
// cau_arena_finish.
void *cau_arena_array(cau_arena *arena, size_t count, size_t size);

// Copy of `count` elements of `size` bytes, likewise.
void *cau_arena_copy(cau_arena *arena, const void *source, size_t count, size_t size);

void cau_arena_finish(cau_arena *arena);

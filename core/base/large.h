// SPDX-License-Identifier: GPL-3.0-or-later
// A heap whose large pieces are whole pages, which sessions may share (base/image.h). For libraries
// that allocate memory by functions like malloc.
#pragma once

#include <stddef.h>

#include "base/pages.h"

void *cau_large_malloc(size_t bytes); // NULL if there is no memory
void *cau_large_calloc(size_t count, size_t size);
void *cau_large_realloc(void *memory, size_t bytes);
void cau_large_free(void *memory); // accepts NULL

// Returns the pages of this piece, still owned by the heap. Empty if the piece is small or NULL.
cau_pages cau_large_pages(const void *memory);

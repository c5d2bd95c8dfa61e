// SPDX-License-Identifier: GPL-3.0-or-later
// A heap whose large pieces are whole pages, which sessions may share (base/image.h): for libraries
// that take their memory by functions like malloc's.
#pragma once

#include <stddef.h>

#include "base/pages.h"

void *cau_large_malloc(size_t bytes); // NULL without memory
void *cau_large_calloc(size_t count, size_t size);
void *cau_large_realloc(void *memory, size_t bytes);
void cau_large_free(void *memory); // takes NULL

// The pages that this piece lies in; empty if it is small, or NULL. Borrowed.
cau_pages cau_large_pages(const void *memory);

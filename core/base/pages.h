// SPDX-License-Identifier: GPL-3.0-or-later
// Memory straight from the system, for what is large and lives shortly: given back at once, where
// the heap would keep it resident, in pieces that the next one may not fit.
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct cau_pages {
	void *start; // zeroed, aligned to a page
	size_t byte_count;
} cau_pages;

// Takes at least byte_count bytes (above 0). Returns false when memory ran out; *pages is empty
// then.
bool cau_pages_take(cau_pages *pages, size_t byte_count);
void cau_pages_give_back(cau_pages *pages); // takes empty ones

// Bytes that the whole program holds in pages; any thread may ask.
size_t cau_pages_held(void);

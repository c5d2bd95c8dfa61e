// SPDX-License-Identifier: GPL-3.0-or-later
// Memory allocated directly from the system, for large allocations with a short life. When it is
// released, it returns to the system at once. The heap would keep it resident, in pieces that may
// not fit the next allocation.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct cau_pages {
	void *start; // first byte: zeroed memory, aligned to a page
	size_t byte_count;
} cau_pages;

// Allocates at least byte_count bytes (above 0). Returns false if there is no memory; *pages is
// then empty.
bool cau_pages_take(cau_pages *pages, size_t byte_count);
void cau_pages_give_back(cau_pages *pages); // accepts empty pages

// Fills `touched`, one entry for each whole system page from pages->start on. An entry is true if
// the page may have memory of its own: it has been written, or is swapped out. All other pages are
// zero and have no memory; reading them would allocate some. If the system gives no information
// (Linux without /proc), all entries are true.
void cau_pages_touched(const cau_pages *pages, uint8_t *touched);

// Returns the bytes that the whole program holds in pages. Any thread may call it.
size_t cau_pages_held(void);

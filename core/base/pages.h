// SPDX-License-Identifier: GPL-3.0-or-later
// Memory straight from the system, for what is large and lives shortly: given back at once, where
// the heap would keep it resident, in pieces that the next one may not fit.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct cau_pages {
	void *start; // zeroed, aligned to a page
	size_t byte_count;
} cau_pages;

// Takes at least byte_count bytes (above 0). Returns false when memory ran out; *pages is empty
// then.
bool cau_pages_take(cau_pages *pages, size_t byte_count);
void cau_pages_give_back(cau_pages *pages); // takes empty ones

// Fills `touched`, one for each whole page of the system's from pages->start on: whether it may
// have memory of its own, as one that was written has, also while it is swapped out. The others are
// all zero and take none; reading them would give them some. All are touched where the system does
// not say (Linux without /proc).
void cau_pages_touched(const cau_pages *pages, uint8_t *touched);

// Bytes that the whole program holds in pages; any thread may ask.
size_t cau_pages_held(void);

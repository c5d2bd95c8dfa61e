// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/pages.h"

#include <stdatomic.h>
#include <sys/mman.h>

#include "cautery/assert.h"

static atomic_size_t held;

bool cau_pages_take(cau_pages *pages, size_t byte_count)
{
	CAU_ASSERT(byte_count > 0, "pages for %zu bytes", byte_count);
	*pages = (cau_pages){0};
	void *start =
		mmap(NULL, byte_count, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	if (start == MAP_FAILED)
		return false;
	*pages = (cau_pages){start, byte_count};
	atomic_fetch_add(&held, byte_count);
	return true;
}

void cau_pages_give_back(cau_pages *pages)
{
	if (!pages->start)
		return;
	munmap(pages->start, pages->byte_count);
	CAU_ASSERT(atomic_load(&held) >= pages->byte_count, "%zu bytes given back of %zu held",
	           pages->byte_count, atomic_load(&held));
	atomic_fetch_sub(&held, pages->byte_count);
	*pages = (cau_pages){0};
}

size_t cau_pages_held(void)
{
	return atomic_load(&held);
}

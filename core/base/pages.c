// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"

#include <fcntl.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

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

// Linux has a 64-bit entry for each page of the program. Two bits of the entry can be read without
// privilege [Linux, admin-guide/mm/pagemap].
void cau_pages_touched(const cau_pages *pages, uint8_t *touched)
{
	const uint64_t present = 1ULL << 63, swapped = 1ULL << 62;
	size_t page = (size_t)sysconf(_SC_PAGESIZE), count = pages->byte_count / page, known = 0;
	size_t first = (uintptr_t)pages->start / page;
	memset(touched, true, count);
	int file = open("/proc/self/pagemap", O_RDONLY | O_CLOEXEC);
	uint64_t entry[512];
	while (file >= 0 && known < count) {
		size_t wanted = count - known < 512 ? count - known : 512;
		ssize_t got =
			pread(file, entry, wanted * sizeof *entry, (off_t)((first + known) * sizeof *entry));
		if (got < (ssize_t)sizeof *entry)
			break;
		for (size_t k = 0; k < (size_t)got / sizeof *entry; k++)
			touched[known++] = (entry[k] & (present | swapped)) != 0;
	}
	if (file >= 0)
		close(file);
}

size_t cau_pages_held(void)
{
	return atomic_load(&held);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Replaces base/pages.c, by the linker, in tests that restore thousands of snapshots. Pages that
// are given back are kept for the next request. Unmapping them took half of the time of such a
// test, because each time the kernel interrupts the other processors. Kept pages are filled with
// ones (not a number, or -1), so a read after their return finds no valid state. The replacement is
// not used under sanitizers and in fuzzing, where such a read ends the program.
#include <pthread.h>
#include <string.h>

#include "base/memory.h"

// KEPT_MOST: largest number of kept blocks. BYTES_MOST: size up to which a block is kept. SPENT:
// the byte with which kept blocks are filled. An arena's block that is large because of an
// announced count is hardly used, and filling it would take longer.
enum { KEPT_MOST = 16, BYTES_MOST = 256 << 10, SPENT = 0xff };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static cau_pages kept[KEPT_MOST];
static int kept_count;

bool __real_cau_pages_take(cau_pages *pages, size_t byte_count);
bool __wrap_cau_pages_take(cau_pages *pages, size_t byte_count);
void __real_cau_pages_give_back(cau_pages *pages);
void __wrap_cau_pages_give_back(cau_pages *pages);

// Removes an entry. The other entries keep the order in which their blocks were given back.
static void leave_out(int index)
{
	kept_count--;
	memmove(kept + index, kept + index + 1, (size_t)(kept_count - index) * sizeof *kept);
}

static bool take_kept(cau_pages *pages, size_t byte_count)
{
	bool found = false;
	pthread_mutex_lock(&lock);
	for (int i = 0; i < kept_count && !found; i++)
		if (kept[i].byte_count == byte_count) {
			found = true;
			*pages = kept[i];
			leave_out(i);
		}
	pthread_mutex_unlock(&lock);
	return found;
}

bool __wrap_cau_pages_take(cau_pages *pages, size_t byte_count)
{
	if (!take_kept(pages, byte_count))
		return __real_cau_pages_take(pages, byte_count);
	memset(pages->start, 0, byte_count);
	return true;
}

void __wrap_cau_pages_give_back(cau_pages *pages)
{
	cau_pages oldest = {0};
	if (!pages->start || pages->byte_count > BYTES_MOST) {
		__real_cau_pages_give_back(pages);
		return;
	}
	memset(pages->start, SPENT, pages->byte_count);
	pthread_mutex_lock(&lock);
	if (kept_count == KEPT_MOST) {
		oldest = kept[0];
		leave_out(0);
	}
	kept[kept_count++] = *pages;
	pthread_mutex_unlock(&lock);
	__real_cau_pages_give_back(&oldest);
	*pages = (cau_pages){0};
}

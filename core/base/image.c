// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/image.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "cautery/assert.h"

// A process may have 65,530 mappings by default. Shorter runs stay as they are, and a session adds
// at most twice as many as the runs it is shown.
enum { LEAST_RUN_BYTES = 64 << 10, MOST_RUNS = 64 };

typedef struct image_part {
	size_t at, page_count; // in the file, in pages
} image_part;

struct cau_image {
	cau_image *next;
	uint64_t key;
	int32_t holders;
	int file;
	char *view;  // the whole file, to compare with
	size_t page; // bytes: the system's, less than which nothing can be mapped
	size_t page_count;
	int32_t part_count;
	image_part part[CAU_IMAGE_PARTS];
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; // guards the list and the holders
static cau_image *images;

// Whole pages of what was taken; the last one may be a part of a page.
static size_t pages_of(const cau_image *image, const cau_pages *pages)
{
	CAU_ASSERT((uintptr_t)pages->start % image->page == 0, "pages at %p", pages->start);
	return pages->byte_count / image->page;
}

// Between arrays there are bytes that no one may touch; these two read them all the same.
__attribute__((no_sanitize("address"))) static bool same_page(const char *a, const char *b,
                                                              size_t bytes)
{
	const uint64_t *x = (const void *)a, *y = (const void *)b;
	uint64_t differ = 0;
	for (size_t k = 0; k < bytes / 8; k++)
		differ |= x[k] ^ y[k];
	return differ == 0;
}

__attribute__((no_sanitize("address"))) static void copy_pages(char *to, const char *from,
                                                               size_t bytes)
{
	uint64_t *x = (void *)to;
	const uint64_t *y = (const void *)from;
	for (size_t k = 0; k < bytes / 8; k++)
		x[k] = y[k];
}

// What a mapping may be refused for, their number and the address space, is looked at before the
// old pages go, and the new ones are charged as the old ones were: it replaces them, or nothing.
static bool map_over(const cau_image *image, size_t first, size_t count, char *start)
{
	return mmap(start, count * image->page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_FIXED,
	            image->file, (off_t)(first * image->page)) != MAP_FAILED;
}

static size_t bytes_of(const cau_image *image)
{
	return image->page_count * image->page;
}

// ---- making
static void destroy(cau_image *image)
{
	if (image->view)
		munmap(image->view, bytes_of(image));
	if (image->file >= 0)
		close(image->file);
	free(image);
}

static void lay_out(cau_image *image, const cau_pages *pages, int32_t count)
{
	image->part_count = count < CAU_IMAGE_PARTS ? count : CAU_IMAGE_PARTS;
	for (int32_t i = 0; i < image->part_count; i++) {
		image->part[i] = (image_part){image->page_count, pages_of(image, &pages[i])};
		image->page_count += image->part[i].page_count;
	}
}

// A file in memory that nobody can run: systems may refuse any other (vm.memfd_noexec), and those
// before Linux 6.3 do not know the flag.
static int make_file(void)
{
	enum { NOEXEC_SEAL = 8 }; // MFD_NOEXEC_SEAL, of headers from then on
	const unsigned flags = MFD_CLOEXEC | MFD_ALLOW_SEALING;
	int file = memfd_create("cautery-image", flags | NOEXEC_SEAL);
	return file < 0 && errno == EINVAL ? memfd_create("cautery-image", flags) : file;
}

// Memory is taken at once: a file that grows as it is written would end the program where it ends.
static bool open_file(cau_image *image)
{
	image->file = make_file();
	if (image->file < 0 || fallocate(image->file, 0, 0, (off_t)bytes_of(image)))
		return false;
	void *view = mmap(NULL, bytes_of(image), PROT_READ | PROT_WRITE, MAP_SHARED, image->file, 0);
	if (view == MAP_FAILED)
		return false;
	image->view = view;
	return true;
}

static void fill(const cau_image *image, const cau_pages *pages)
{
	for (int32_t i = 0; i < image->part_count; i++)
		copy_pages(image->view + image->part[i].at * image->page, pages[i].start,
		           image->part[i].page_count * image->page);
}

// The seal is refused while there is a way to write.
static bool seal(cau_image *image)
{
	munmap(image->view, bytes_of(image));
	image->view = NULL;
	if (fcntl(image->file, F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_SEAL))
		return false;
	void *view = mmap(NULL, bytes_of(image), PROT_READ, MAP_SHARED, image->file, 0);
	image->view = view == MAP_FAILED ? NULL : view;
	return image->view != NULL;
}

static cau_image *make(uint64_t key, const cau_pages *pages, int32_t count)
{
	cau_image *image = calloc(1, sizeof *image);
	if (!image)
		return NULL;
	image->key = key;
	image->file = -1;
	image->page = (size_t)sysconf(_SC_PAGESIZE);
	lay_out(image, pages, count);
	bool fits = image->page_count > 0 && bytes_of(image) <= CAU_IMAGE_BYTES;
	if (fits && open_file(image)) {
		fill(image, pages);
		if (seal(image))
			return image;
	}
	destroy(image);
	return NULL;
}

// ---- the list
static cau_image *hold(uint64_t key)
{
	cau_image *found = images;
	while (found && found->key != key)
		found = found->next;
	if (found)
		found->holders++;
	return found;
}

cau_image *cau_image_of(uint64_t key, const cau_pages *pages, int32_t count, bool *made)
{
	bool ignored;
	*(made ? made : &ignored) = false;
	pthread_mutex_lock(&lock);
	cau_image *image = hold(key);
	pthread_mutex_unlock(&lock);
	if (image)
		return image;
	cau_image *own = make(key, pages, count); // copies for long, and nobody waits
	pthread_mutex_lock(&lock);
	image = hold(key); // another thread's, made meanwhile
	if (!image && own) {
		own->holders = 1;
		own->next = images;
		image = images = own;
		own = NULL;
		*(made ? made : &ignored) = true;
	}
	pthread_mutex_unlock(&lock);
	if (own)
		destroy(own);
	return image;
}

void cau_image_release(cau_image *image)
{
	if (!image)
		return;
	pthread_mutex_lock(&lock);
	CAU_ASSERT(image->holders > 0, "%d holders of an image", image->holders);
	bool last = --image->holders == 0;
	cau_image **at = &images;
	while (last && *at != image)
		at = &(*at)->next;
	if (last)
		*at = image->next;
	pthread_mutex_unlock(&lock);
	if (last)
		destroy(image);
}

int32_t cau_image_count(void)
{
	int32_t count = 0;
	pthread_mutex_lock(&lock);
	for (const cau_image *image = images; image; image = image->next)
		count++;
	pthread_mutex_unlock(&lock);
	return count;
}

// ---- showing
// The next run of equal pages at or after *first: its length, 0 at the end. `equal`: all are.
static size_t find_run(const cau_image *image, const image_part *part, const char *start,
                       bool equal, size_t *first)
{
	size_t k = *first, length = 0, least = LEAST_RUN_BYTES / image->page;
	for (; k < part->page_count; k++) {
		if (equal || same_page(image->view + (part->at + k) * image->page, start + k * image->page,
		                       image->page)) {
			length++;
			continue;
		}
		if (length && length >= least)
			break;
		length = 0;
	}
	*first = k - length;
	return length >= least ? length : 0;
}

size_t cau_image_show(const cau_image *image, const cau_pages *pages, int32_t count, bool equal)
{
	size_t shown = 0;
	int32_t runs = 0;
	for (int32_t i = 0; i < count && i < image->part_count; i++) {
		const image_part *part = &image->part[i];
		if (pages_of(image, &pages[i]) != part->page_count)
			continue;
		char *start = pages[i].start;
		size_t length;
		for (size_t k = 0; runs < MOST_RUNS && (length = find_run(image, part, start, equal, &k));
		     k += length, runs++) {
			if (!map_over(image, part->at + k, length, start + k * image->page))
				return shown * image->page;
			shown += length;
		}
	}
	return shown * image->page;
}

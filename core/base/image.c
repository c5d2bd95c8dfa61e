// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "cautery/assert.h"

// LEAST_RUN_BYTES: shortest run of equal pages that is mapped. MOST_RUNS: most runs that are
// mapped. Runs are limited in length and number because a process may have 65,530 mappings by
// default. A session gets at most twice as many mappings as it has mapped runs.
enum { LEAST_RUN_BYTES = 16 << 10, MOST_RUNS = 64 };

typedef struct image_part {
	size_t at, page_count; // start in `place`, and length
} image_part;

struct cau_image {
	cau_image *next;
	uint64_t key;
	int32_t holders;
	int file;
	char *view;          // the whole file, read-only once sealed, for comparison
	size_t page;         // page size of the system, bytes: the smallest mapping
	size_t page_count;   // pages in the file
	size_t listed_count; // pages of all parts
	uint32_t *place; // (listed_count): page in the file, counted from 1; 0: the page was untouched
	int32_t part_count;
	image_part part[CAU_IMAGE_PARTS];
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; // guards the list and holder counts
static cau_image *images;

// Returns the number of whole pages. The allocation may end within a page.
static size_t pages_of(const cau_image *image, const cau_pages *pages)
{
	CAU_ASSERT((uintptr_t)pages->start % image->page == 0, "pages at %p", pages->start);
	return pages->byte_count / image->page;
}

// True if two pages are equal. Between arrays there are bytes that the address sanitizer forbids to
// read. same_page and copy_pages read these bytes as part of a page.
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

// Maps pages of the image over a session's pages. The system checks the number of mappings and the
// address space before it removes the old pages. The new pages need no more reserved memory than
// the old ones. So a failed call leaves the old pages in place.
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
	free(image->place);
	free(image);
}

// Assigns a page of the file to each page that was touched, in order. Returns false if no page was
// touched, or if too many were.
static bool lay_out(cau_image *image, const cau_pages *pages, int32_t count)
{
	image->part_count = count < CAU_IMAGE_PARTS ? count : CAU_IMAGE_PARTS;
	for (int32_t i = 0; i < image->part_count; i++) {
		image->part[i] = (image_part){image->listed_count, pages_of(image, &pages[i])};
		image->listed_count += image->part[i].page_count;
	}
	if (!image->listed_count || image->listed_count > CAU_IMAGE_BYTES / image->page)
		return false;
	image->place = calloc(image->listed_count, sizeof *image->place);
	uint8_t *touched = malloc(image->listed_count);
	for (int32_t i = 0; i < image->part_count && image->place && touched; i++) {
		uint32_t *place = image->place + image->part[i].at;
		cau_pages_touched(&pages[i], touched);
		for (size_t k = 0; k < image->part[i].page_count; k++)
			if (touched[k])
				place[k] = (uint32_t)++image->page_count;
	}
	free(touched);
	return image->page_count > 0;
}

// Creates a file in memory that cannot be executed. Systems may refuse other files in memory
// (vm.memfd_noexec). Systems before Linux 6.3 do not know the flag.
static int make_file(void)
{
	enum { NOEXEC_SEAL = 8 }; // MFD_NOEXEC_SEAL, as defined in headers since Linux 6.3
	const unsigned flags = MFD_CLOEXEC | MFD_ALLOW_SEALING;
	int file = memfd_create("cautery-image", flags | NOEXEC_SEAL);
	return file < 0 && errno == EINVAL ? memfd_create("cautery-image", flags) : file;
}

// Allocates the file's memory at once. If the file grew with each write and memory ran out, the
// write would end the program.
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

// Returns a listed page's address in the view; NULL if the page is not in the file.
static char *view_of(const cau_image *image, size_t listed)
{
	uint32_t place = image->place[listed];
	return place ? image->view + (place - 1) * image->page : NULL;
}

static void fill(const cau_image *image, const cau_pages *pages)
{
	for (int32_t i = 0; i < image->part_count; i++) {
		const char *start = pages[i].start;
		for (size_t k = 0; k < image->part[i].page_count; k++) {
			char *to = view_of(image, image->part[i].at + k);
			if (to)
				copy_pages(to, start + k * image->page, image->page);
		}
	}
}

// Makes the file read-only. The seal is refused while a writable mapping exists.
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
	if (lay_out(image, pages, count) && open_file(image)) {
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
	cau_image *own = make(key, pages, count); // without the lock, because the copy takes long
	pthread_mutex_lock(&lock);
	image = hold(key); // another thread may have made the image meanwhile
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

// ---- mapping
// The work of mapping an image over one session's pages that are equal to the image's.
typedef struct showing {
	const cau_image *image;
	const image_part *part;
	char *start;
	uint8_t *touched; // (page_count): pages of the part that were touched
	bool equal;       // all pages are known to be equal
	int32_t runs;     // runs mapped so far, in all parts
	size_t shown;     // pages mapped so far, in all parts
} showing;

static bool is_equal(const showing *s, size_t k)
{
	const char *view = view_of(s->image, s->part->at + k);
	return s->touched[k] && view &&
	       (s->equal || same_page(view, s->start + k * s->image->page, s->image->page));
}

// Finds the next run of equal pages at or after *first. Sets *first to the run's start and returns
// its length; 0 at the end. Pages that are adjacent in a part and in the image are adjacent in the
// image's file too.
static size_t find_run(const showing *s, size_t *first)
{
	size_t k = *first, length = 0, least = LEAST_RUN_BYTES / s->image->page;
	for (; k < s->part->page_count; k++) {
		if (is_equal(s, k)) {
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

static bool show_part(showing *s)
{
	const cau_image *image = s->image;
	size_t length;
	for (size_t k = 0; s->runs < MOST_RUNS && (length = find_run(s, &k)); k += length, s->runs++) {
		size_t place = image->place[s->part->at + k] - 1;
		if (!map_over(image, place, length, s->start + k * image->page))
			return false;
		s->shown += length;
	}
	return true;
}

size_t cau_image_show(const cau_image *image, const cau_pages *pages, int32_t count, bool equal)
{
	showing s = {.image = image, .equal = equal, .touched = malloc(image->listed_count)};
	bool mapped = s.touched != NULL;
	for (int32_t i = 0; mapped && i < count && i < image->part_count; i++) {
		s.part = &image->part[i];
		s.start = pages[i].start;
		if (pages_of(image, &pages[i]) != s.part->page_count)
			continue;
		cau_pages_touched(&pages[i], s.touched);
		mapped = show_part(&s);
	}
	free(s.touched);
	return s.shown * image->page;
}

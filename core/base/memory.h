// SPDX-License-Identifier: GPL-3.0-or-later
// Memory of sessions, in whole pages: pages from the system, arenas for the arrays of a session, a
// heap for libraries, and images, by which sessions of equal tissue share pages.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// ---- pages
// Memory allocated directly from the system, for large allocations with a short life. When it is
// released, it returns to the system at once. The heap would keep it resident, in pieces that may
// not fit the next allocation.
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

// ---- arenas
// All arrays of a session come from one arena, so that one call frees them. The arrays are in whole
// pages, which sessions of equal tissue may share by images.
typedef struct cau_arena {
	struct cau_arena_block *blocks; // newest first
	size_t byte_count;              // bytes allocated so far
} cau_arena;

// Returns a zeroed array of `count` elements of `size` bytes, aligned to 64 bytes and padded by 64.
// Returns NULL if there is no memory or count * size overflows. A count of 0 gives a valid pointer.
// cau_arena_finish frees the array.
void *cau_arena_array(cau_arena *arena, size_t count, size_t size);

// Copies `count` elements of `size` bytes to an array as cau_arena_array makes it. NULL if there is
// no memory.
void *cau_arena_copy(cau_arena *arena, const void *source, size_t count, size_t size);

void cau_arena_finish(cau_arena *arena);

// Writes the pages of the arena's blocks, newest first, at most `most`. Returns their number.
// Arenas with the same allocations in the same order have blocks of the same sizes. The arena still
// owns the pages.
int32_t cau_arena_pages(const cau_arena *arena, cau_pages *pages, int32_t most);

// ---- a heap
// Its large pieces are whole pages, which sessions may share by images. For libraries that allocate
// memory by functions like malloc.
void *cau_large_malloc(size_t bytes); // NULL if there is no memory
void *cau_large_calloc(size_t count, size_t size);
void *cau_large_realloc(void *memory, size_t bytes);
void cau_large_free(void *memory); // accepts NULL

// Returns the pages of this piece, still owned by the heap. Empty if the piece is small or NULL.
cau_pages cau_large_pages(const void *memory);

// ---- images
// Memory that sessions of equal tissue share. An image is a copy of one session's pages, in a file
// in memory that is no longer writable. Private mappings of this file replace another session's
// pages that have equal bytes. The first write to a page copies the page for the session that
// writes. So no session sees the writes of another. Which pages are equal need not be known
// beforehand.
//
// Pages that were never touched are in no image and are not read, because the system keeps no
// memory for them. They are most of a small session's pages.
//
// All images of the program are in one list. An image exists as long as a session holds it. Any
// thread may call these functions. The owner of the pages calls them, while no other thread reads
// or writes the pages.
enum {
	CAU_IMAGE_PARTS = 512,       // allocations of one image; further ones are not shared
	CAU_IMAGE_BYTES = 256 << 20, // largest image; a copy of more would take too long
};

typedef struct cau_image cau_image;

// Returns the image of this key and holds it once more. If there is no such image, makes an image
// from these pages. Returns NULL if no page was touched, if the system does not allow images, or if
// there is no memory. Pages with the same position in the list are compared, so the list should
// have the same order each time. *made (may be NULL) is set to whether the image was made from
// these pages.
cau_image *cau_image_of(uint64_t key, const cau_pages *pages, int32_t count, bool *made);
// Maps the image over the pages that are equal to the image's pages, and returns the bytes that
// were mapped. `equal`: all pages are known to be equal, because the image was made from them and
// nothing has written to them since. Then no page is compared, which saves most of the time.
size_t cau_image_show(const cau_image *image, const cau_pages *pages, int32_t count, bool equal);
// Releases one hold. The last release deletes the image. Its mappings stay until their pages are
// released.
void cau_image_release(cau_image *image); // accepts NULL

int32_t cau_image_count(void); // returns the number of images in the whole program

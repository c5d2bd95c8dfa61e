// SPDX-License-Identifier: GPL-3.0-or-later
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
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/pages.h"

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

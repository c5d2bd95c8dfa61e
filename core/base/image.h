// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that sessions of equal tissue have in common: an image is a copy of one session's pages,
// in a file in memory that is no longer writable. Private mappings of it replace another session's
// pages with equal bytes. The first write copies a page for the writer, so no session sees writes
// of another. The equal pages need not be known beforehand.
//
// Pages that were never touched are in no image, and are not read: the system keeps no memory for
// them. They are most of a small session's.
//
// Images live in one list for the whole program, and as long as a session holds them. Any thread
// may call these; who owns the pages calls for them, while nothing else reads or writes them.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/pages.h"

enum {
	CAU_IMAGE_PARTS = 512, // pieces of memory of one image; further ones have no part in it
	CAU_IMAGE_BYTES =
		256 << 20, // of its pages: there is no image of more, which takes long to copy
};

typedef struct cau_image cau_image;

// The image of this key, held once more; if there is none, it is made of these pages, which become
// the first that are shown. NULL: none was touched, or the system does not allow it, or has no
// memory for it. Pages of equal place in the list are compared: they should be listed in the same
// order each time. *made (may be NULL): whether it was made of these pages.
cau_image *cau_image_of(uint64_t key, const cau_pages *pages, int32_t count, bool *made);
// Maps the image over those of the pages that are equal to it; returns their bytes. `equal`: all
// are equal, as it was made of them and nothing has written them since. Then none is compared,
// which takes longer than the rest.
size_t cau_image_show(const cau_image *image, const cau_pages *pages, int32_t count, bool equal);
// What was mapped stays so until its pages are given back. The last holder's release ends it.
void cau_image_release(cau_image *image); // takes NULL

int32_t cau_image_count(void); // of the whole program

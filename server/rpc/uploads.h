// SPDX-License-Identifier: GPL-3.0-or-later
// The files that a connection has sent, and those that are coming in. They are kept until they are
// discarded, replaced by another of the same name, or the connection ends. What bounds them is
// bytes: of one file, of a connection, and of all connections together.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/messages.h"
#include "config/config.h"
#include "fill/fill.h"

// What an upload counts for at least, so that countless small ones are bounded too.
enum { CAU_UPLOAD_LEAST_BYTES = 65536 };

typedef struct cau_upload {
	struct cau_upload *next;
	uint32_t transfer;
	char name[CAU_NAME_BYTES];
	char file_name[129];
	unsigned char *bytes; // NULL once it is spoilt
	size_t byte_count, received;
	bool complete;
	cau_filling *filling; // of the last mesh.read that may fill it; NULL: none
	char trouble[160];    // what spoilt it; told by upload.end
} cau_upload;

// Of all connections together; the network thread's alone.
typedef struct cau_upload_total {
	int64_t bytes; // announced, each at least CAU_UPLOAD_LEAST_BYTES
} cau_upload_total;

typedef struct cau_uploads {
	cau_upload *first;
	int64_t bytes; // as in the total
	uint32_t last_transfer;
} cau_uploads;

// Makes room for a file. One of the same name, whole or not, is dropped if this one is taken.
// CAU_LIMIT names the limit and its setting.
cau_status cau_uploads_begin(cau_uploads *uploads, cau_upload_total *total,
                             const cau_config *config, const cau_wire_upload_begin *wanted,
                             cau_upload **made, cau_error *error);
// NULL if there is none.
cau_upload *cau_uploads_find(cau_uploads *uploads, const char *name);
cau_upload *cau_uploads_find_transfer(cau_uploads *uploads, uint32_t transfer);

// Puts a chunk's bytes in their place; what does not fit spoils the upload.
void cau_upload_take(cau_upload *upload, uint64_t offset, const void *data, size_t bytes);
// Whether all has come and has this hash; tells why not.
cau_status cau_upload_check(const cau_upload *upload, const char *sha256, cau_error *error);

// Another filling (taken; NULL: none) in the place of the one before, which is cancelled.
void cau_upload_refill(cau_upload *upload, cau_filling *filling);
void cau_uploads_drop(cau_uploads *uploads, cau_upload_total *total, cau_upload *upload);
void cau_uploads_drop_all(cau_uploads *uploads, cau_upload_total *total);

// SPDX-License-Identifier: GPL-3.0-or-later
// The files that a connection has uploaded or is uploading. A file stays until it is discarded,
// replaced by another of the same name, or the connection ends. The limits are bytes: of one file,
// of a connection, and of all connections together.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/messages.h"
#include "config/config.h"
#include "fill/fill.h"

// Least bytes that an upload counts as in the limits, so that the number of small uploads is
// limited too.
enum { CAU_UPLOAD_LEAST_BYTES = 65536 };

typedef struct cau_upload {
	struct cau_upload *next;
	uint32_t transfer;
	char name[CAU_NAME_BYTES];
	char file_name[129];
	unsigned char *bytes; // NULL once an error has spoilt the upload
	size_t byte_count, received;
	bool complete;
	cau_filling *filling; // from the last mesh.read that may fill the mesh; NULL: none
	char trouble[160];    // why the upload is spoilt; upload.end reports it
} cau_upload;

// Sums over all connections; used by the network thread only.
typedef struct cau_upload_total {
	int64_t bytes; // announced bytes; each upload counts at least CAU_UPLOAD_LEAST_BYTES
} cau_upload_total;

typedef struct cau_uploads {
	cau_upload *first;
	int64_t bytes; // sum for this connection, counted as in cau_upload_total
	uint32_t last_transfer;
} cau_uploads;

// Begins an upload. If it is accepted, an upload of the same name, complete or not, is dropped.
// CAU_LIMIT names the limit and its setting.
cau_status cau_uploads_begin(cau_uploads *uploads, cau_upload_total *total,
                             const cau_config *config, const cau_wire_upload_begin *wanted,
                             cau_upload **made, cau_error *error);
// Return the upload with this name or transfer; NULL if there is none.
cau_upload *cau_uploads_find(cau_uploads *uploads, const char *name);
cau_upload *cau_uploads_find_transfer(cau_uploads *uploads, uint32_t transfer);

// Stores a chunk's bytes. A chunk that does not follow the received bytes spoils the upload.
void cau_upload_take(cau_upload *upload, uint64_t offset, const void *data, size_t bytes);
// Checks that all bytes have come and have this hash. *error describes a failure.
cau_status cau_upload_check(const cau_upload *upload, const char *sha256, cau_error *error);

// Sets the upload's filling and takes ownership of `filling` (NULL: no filling). Cancels the
// upload's previous filling.
void cau_upload_refill(cau_upload *upload, cau_filling *filling);
void cau_uploads_drop(cau_uploads *uploads, cau_upload_total *total, cau_upload *upload);
void cau_uploads_drop_all(cau_uploads *uploads, cau_upload_total *total);

// SPDX-License-Identifier: GPL-3.0-or-later
// Binary chunks of files: client to server for uploads, server to client for exports.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

enum {
	CAU_CHUNK_HEADER_BYTES = 16,
	CAU_CHUNK_BYTES_MAX = 262144, // of data in one chunk
};

typedef struct cau_chunk {
	uint32_t transfer; // as upload.begin, session.export or session.log answered
	uint64_t offset;   // of the first byte in the file
	const void *data;  // borrowed from the message
	size_t byte_count;
} cau_chunk;

// Errors: CAU_CORRUPT (no chunk), CAU_LIMIT (empty or more than CAU_CHUNK_BYTES_MAX).
cau_status cau_chunk_read(const void *bytes, size_t byte_count, cau_chunk *chunk, cau_error *error);

// Writes the header that goes before the data.
void cau_chunk_header_write(uint8_t header[CAU_CHUNK_HEADER_BYTES], const cau_chunk *chunk);

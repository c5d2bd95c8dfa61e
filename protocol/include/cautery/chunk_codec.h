// SPDX-License-Identifier: Apache-2.0
// Binary chunks of files. A client sends them for uploads, the server for exports.
//
//     #include <string.h>
//
//     #include "cautery/chunk_codec.h"
//
//     // Copies a chunk to its position in a file that is being received.
//     static cau_status take_chunk(const void *message, size_t bytes, uint8_t *file,
//                                  size_t file_bytes, cau_error *error)
//     {
//         cau_chunk chunk;
//         cau_status status = cau_chunk_read(message, bytes, &chunk, error);
//         if (status)
//             return status;
//         if (chunk.offset > file_bytes || chunk.byte_count > file_bytes - chunk.offset)
//             return cau_fail(error, CAU_LIMIT, "offset", "beyond the file's end");
//         memcpy(file + chunk.offset, chunk.data, chunk.byte_count);
//         return CAU_OK;
//     }
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
	CAU_CHUNK_HEADER_BYTES = 16,  // size of the header before the data
	CAU_CHUNK_BYTES_MAX = 262144, // largest data in one chunk
};

// A piece of a file.
typedef struct cau_chunk {
	uint32_t transfer; // id of the transfer from upload.begin, session.export or session.log
	uint64_t offset;   // position of the first byte in the file
	const void *data;  // borrowed from the message
	size_t byte_count; // size of `data`
} cau_chunk;

// Reads a chunk. Errors: CAU_CORRUPT (no chunk), CAU_LIMIT (empty or more than
// CAU_CHUNK_BYTES_MAX).
cau_status cau_chunk_read(const void *bytes, size_t byte_count, cau_chunk *chunk, cau_error *error);

// Writes the header that precedes the data.
void cau_chunk_header_write(uint8_t header[CAU_CHUNK_HEADER_BYTES], const cau_chunk *chunk);

#ifdef __cplusplus
}
#endif

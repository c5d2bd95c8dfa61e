// SPDX-License-Identifier: Apache-2.0
#include "cautery/chunk_codec.h"

#include "wire/bytes.h"

static const uint8_t magic[4] = {'C', 'A', 'U', 'C'};

cau_status cau_chunk_read(const void *bytes, size_t byte_count, cau_chunk *chunk, cau_error *error)
{
	const uint8_t *at = bytes;
	if (byte_count < CAU_CHUNK_HEADER_BYTES || memcmp(at, magic, sizeof magic) != 0)
		return cau_fail(error, CAU_CORRUPT, "header", "the bytes are not a chunk");
	*chunk = (cau_chunk){.transfer = load_u32(at + 4),
	                     .offset = load_u64(at + 8),
	                     .data = at + CAU_CHUNK_HEADER_BYTES,
	                     .byte_count = byte_count - CAU_CHUNK_HEADER_BYTES};
	if (chunk->byte_count == 0 || chunk->byte_count > CAU_CHUNK_BYTES_MAX)
		return cau_fail(error, CAU_LIMIT, "data", "%zu bytes are not within 1 and %d",
		                chunk->byte_count, CAU_CHUNK_BYTES_MAX);
	return CAU_OK;
}

void cau_chunk_header_write(uint8_t header[CAU_CHUNK_HEADER_BYTES], const cau_chunk *chunk)
{
	memcpy(header, magic, sizeof magic);
	store_u32(header + 4, chunk->transfer);
	store_u64(header + 8, chunk->offset);
}

// SPDX-License-Identifier: Apache-2.0
// Arrays, headers and sections of frames.
#include "wire/frame.h"

#include <math.h>

#include "cautery/assert.h"
#include "wire/bytes.h"

// ---- arrays of channels
// The six channels that are no scalars (positions, mask, tools, statistics, vessels, contacts of
// tools) have cases of their own in this file, the encoder and the decoder.
_Static_assert(CAU_CHANNEL_COUNT - CAU_SCALAR_COUNT == 6, "a channel is a scalar or has cases");

int cau_channel_of_section(int type)
{
	int channel = 0;
	while (channel < CAU_CHANNEL_COUNT &&
	       cau_channel_describe((cau_channel_index)channel)->section != type)
		channel++;
	return channel;
}

array_shape cau_array_shape_of(const cau_stream_def *def, int channel)
{
	CAU_ASSERT_INDEX(channel, CAU_CHANNEL_COUNT);
	CAU_ASSERT(def->vertex_count >= 0 && def->face_count >= 0, "%d vertices, %d faces",
	           def->vertex_count, def->face_count);
	size_t vertices = (size_t)def->vertex_count;
	const cau_channel_info *info = cau_channel_describe((cau_channel_index)channel);
	if (!cau_stream_has(def, channel))
		return (array_shape){.components = 1};
	if (info->scalar >= 0)
		return (array_shape){.count = vertices, .components = 1, .most = info->most};
	switch (channel) {
	case CAU_CHANNEL_INDEX_POSITIONS:
		return (array_shape){.count = vertices,
		                     .components = 3,
		                     .bias = POSITION_LIMIT,
		                     .most = 2u * POSITION_LIMIT};
	case CAU_CHANNEL_INDEX_MASK:
		return (array_shape){
			.count = ((size_t)def->face_count + 31) / 32, .components = 1, .most = UINT32_MAX};
	default:
		return (array_shape){.components = 1};
	}
}

size_t cau_arrays_words(const cau_stream_def *def)
{
	size_t words = 0;
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		array_shape shape = cau_array_shape_of(def, channel);
		words += shape.count * shape.components;
	}
	return words;
}

size_t cau_arrays_scratch_bytes(const cau_stream_def *def)
{
	size_t most = 4;
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		array_shape shape = cau_array_shape_of(def, channel);
		size_t bytes = cau_elements_scratch_bytes(shape.count, shape.components);
		most = bytes > most ? bytes : most;
	}
	return most;
}

// ---- headers and sections
static const uint8_t magic[4] = {'C', 'A', 'U', 'F'};

void cau_frame_header_write(uint8_t *out, const cau_frame_header *header)
{
	CAU_RULE(header->kind >= CAU_FRAME_KEY && header->kind <= CAU_FRAME_TOPOLOGY,
	         "a frame of kind %d", header->kind);
	CAU_RULE(header->epoch != 0, "frame %llu of no epoch", (unsigned long long)header->sequence);
	memcpy(out, magic, sizeof magic);
	out[4] = CAU_FRAME_VERSION;
	out[5] = header->kind;
	store_u16(out + 6, header->flags);
	store_u32(out + 8, header->byte_count);
	store_u32(out + 12, header->session);
	store_u64(out + 16, header->epoch);
	store_u64(out + 24, header->sequence);
	store_u64(out + 32, header->base_sequence);
	store_u64(out + 40, header->tick);
	store_f64(out + 48, header->time_s);
	store_u64(out + 56, header->published_us);
	store_u16(out + 64, header->profile);
	store_u16(out + 66, header->section_count);
	store_u32(out + 68, 0);
}

static void load_header(const uint8_t *at, cau_frame_header *header)
{
	*header = (cau_frame_header){
		.version = at[4],
		.kind = at[5],
		.flags = load_u16(at + 6),
		.byte_count = load_u32(at + 8),
		.session = load_u32(at + 12),
		.epoch = load_u64(at + 16),
		.sequence = load_u64(at + 24),
		.base_sequence = load_u64(at + 32),
		.tick = load_u64(at + 40),
		.time_s = load_f64(at + 48),
		.published_us = load_u64(at + 56),
		.profile = load_u16(at + 64),
		.section_count = load_u16(at + 66),
	};
}

cau_status cau_frame_header_read(const void *bytes, size_t byte_count, cau_frame_header *header,
                                 cau_error *error)
{
	const uint8_t *at = bytes;
	if (byte_count < CAU_FRAME_HEADER_BYTES)
		return cau_fail(error, CAU_CORRUPT, "header",
		                "%zu bytes are too few for a frame, whose header has %d", byte_count,
		                CAU_FRAME_HEADER_BYTES);
	if (memcmp(at, magic, sizeof magic) != 0)
		return cau_fail(error, CAU_CORRUPT, "magic", "the bytes do not start with CAUF");
	load_header(at, header);
	if (header->version != CAU_FRAME_VERSION)
		return cau_fail(error, CAU_UNSUPPORTED, "version",
		                "the frame has version %d, this decoder reads %d", header->version,
		                CAU_FRAME_VERSION);
	if (header->kind < CAU_FRAME_KEY || header->kind > CAU_FRAME_TOPOLOGY)
		return cau_fail(error, CAU_CORRUPT, "kind", "no kind of frame has the number %d",
		                header->kind);
	if (header->byte_count != byte_count)
		return cau_fail(error, CAU_CORRUPT, "byte_count", "%zu bytes came, the header says %u",
		                byte_count, header->byte_count);
	if (header->epoch == 0 || !isfinite(header->time_s))
		return cau_fail(error, CAU_CORRUPT, "header", "the epoch is 0 or the time is not finite");
	return CAU_OK;
}

void cau_section_head_write(uint8_t *out, cau_section type, size_t payload_bytes)
{
	out[0] = (uint8_t)type;
	out[1] = out[2] = out[3] = 0;
	store_u32(out + 4, (uint32_t)payload_bytes);
}

section_cursor cau_sections_begin(const void *bytes, const cau_frame_header *header)
{
	const uint8_t *start = bytes;
	return (section_cursor){.at = start + CAU_FRAME_HEADER_BYTES,
	                        .end = start + header->byte_count,
	                        .left = header->section_count};
}

bool cau_sections_next(section_cursor *cursor)
{
	size_t room = (size_t)(cursor->end - cursor->at);
	if (cursor->left == 0 || cursor->wrong) {
		if (!cursor->wrong && room > 0)
			cursor->wrong = "bytes follow the last section";
		return false;
	}
	if (room < CAU_FRAME_SECTION_BYTES) {
		cursor->wrong = "a section is missing";
		return false;
	}
	int type = cursor->at[0];
	size_t payload_bytes = load_u32(cursor->at + 4);
	if (payload_bytes > room - CAU_FRAME_SECTION_BYTES || payload_bytes % 4 != 0) {
		cursor->wrong = "a section is longer than its frame, or its length is not a multiple of 4";
		return false;
	}
	if (type <= cursor->type) {
		cursor->wrong = "section types do not ascend";
		return false;
	}
	cursor->type = type;
	cursor->payload = cursor->at + CAU_FRAME_SECTION_BYTES;
	cursor->payload_bytes = payload_bytes;
	cursor->at = cursor->payload + payload_bytes;
	cursor->left--;
	return true;
}

// SPDX-License-Identifier: Apache-2.0
// The parts of a frame that encoder, thinner and decoder share.
#pragma once

#include <stdbool.h>

#include "cautery/frame_codec.h"
#include "wire/elements.h"

// ---- arrays of channels
// Encoder, thinner and decoder store each array as 32-bit words, indexed by CAU_CHANNEL_INDEX_*.
// Channels with records have arrays without elements.

enum { POSITION_LIMIT = 1 << 30 }; // largest distance from the origin along an axis, in steps

static inline bool cau_stream_has(const cau_stream_def *def, int channel)
{
	return def->channels >> channel & 1;
}

// Returns the channel of a section, CAU_CHANNEL_INDEX_*, or CAU_CHANNEL_COUNT if there is none.
int cau_channel_of_section(int type);

typedef struct array_shape {
	// number of elements; 0 if the stream does not have this channel, or if it is not an array
	size_t count;
	uint32_t components;
	uint32_t bias, most; // limits of the values, see elements_target
} array_shape;

array_shape cau_array_shape_of(const cau_stream_def *def, int channel);

// Returns the number of words of all arrays.
size_t cau_arrays_words(const cau_stream_def *def);
// Returns the largest scratch memory that an array needs.
size_t cau_arrays_scratch_bytes(const cau_stream_def *def);

// ---- headers and sections
// Writes a header of CAU_FRAME_HEADER_BYTES. The written version is always CAU_FRAME_VERSION,
// whatever header->version is.
void cau_frame_header_write(uint8_t *out, const cau_frame_header *header);

// Writes a section's head; `payload_bytes` is a multiple of 4.
void cau_section_head_write(uint8_t *out, cau_section type, size_t payload_bytes);

// Iterates over the sections of a frame whose header was read.
typedef struct section_cursor {
	const uint8_t *at;
	const uint8_t *end;
	int left;               // number of sections not yet read
	int type;               // type of the present section
	const uint8_t *payload; // payload of the present section
	size_t payload_bytes;
	const char *wrong; // description of the frame's first fault, or NULL
} section_cursor;

section_cursor cau_sections_begin(const void *bytes, const cau_frame_header *header);
// Moves to the next section. Returns false after the last section or if the frame is invalid.
bool cau_sections_next(section_cursor *cursor);

// ---- the encoder, for the thinner
typedef struct cau_tool_set {
	int32_t count;
	cau_stream_tool tools[CAU_MAX_TOOLS];
} cau_tool_set;

struct cau_frame_encoder {
	cau_stream_def def;
	cau_frame_header header;           // header of the last frame
	uint32_t *held[CAU_CHANNEL_COUNT]; // state of decoders that have all frames
	uint32_t *next[CAU_CHANNEL_COUNT]; // state of these decoders after the frame that is being made
	cau_tool_set tools;
	cau_stream_statistics statistics;
	int32_t vessel_count;
	cau_vessel_state vessels[CAU_MAX_VESSELS];
	int32_t contact_count;
	cau_tool_contact contacts[CAU_MAX_TOOLS];
	uint8_t *scratch;
};

// True if decoders that know the tools of `set` need the names of `tools`.
bool cau_tool_sets_differ(const cau_tool_set *set, const cau_stream_tool *tools, int32_t count);

cau_status cau_encoder_check_capacity(const cau_frame_encoder *encoder, size_t capacity,
                                      cau_error *error);

// Writes the delta from `base`, the arrays of the state with that sequence, to the present state.
// Returns its length.
size_t cau_encoder_write_delta(const cau_frame_encoder *encoder,
                               uint32_t *const base[CAU_CHANNEL_COUNT], uint64_t base_sequence,
                               bool names, void *bytes);

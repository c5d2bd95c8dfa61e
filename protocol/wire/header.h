// SPDX-License-Identifier: Apache-2.0
// Writes the headers of frames and the heads of sections, and iterates over the sections of a
// frame.
#pragma once

#include "cautery/frame_codec.h"

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
	const char *wrong; // what is wrong with the frame, or NULL
} section_cursor;

section_cursor cau_sections_begin(const void *bytes, const cau_frame_header *header);
// Moves to the next section. Returns false after the last section or if the frame is invalid.
bool cau_sections_next(section_cursor *cursor);

// SPDX-License-Identifier: GPL-3.0-or-later
// The array channels of a stream: what encoder and decoder keep of each as 32-bit words.
#pragma once

#include "cautery/frame_codec.h"
#include "wire/elements.h"

enum {
	ARRAY_COUNT =
		CAU_CHANNEL_INDEX_STRESS + 1, // channels before it are arrays, section = index + 1
	POSITION_LIMIT = 1 << 30,         // steps from the origin
};
_Static_assert((int)CAU_SECTION_POSITIONS == CAU_CHANNEL_INDEX_POSITIONS + 1 &&
                   (int)CAU_SECTION_STRESS == CAU_CHANNEL_INDEX_STRESS + 1,
               "array channels and their sections have the same order");

typedef struct array_shape {
	size_t count; // elements; 0 if the stream has not this channel
	uint32_t components;
	uint32_t bias, most; // of values, see elements_target
} array_shape;

array_shape cau_array_shape_of(const cau_stream_def *def, int channel);

// Words of all arrays together, and scratch that any of them needs.
size_t cau_arrays_words(const cau_stream_def *def);
size_t cau_arrays_scratch_bytes(const cau_stream_def *def);

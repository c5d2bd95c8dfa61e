// SPDX-License-Identifier: Apache-2.0
// The channels that are arrays (positions, mask, scalars). Encoder, thinner and decoder store each
// of them as 32-bit words, indexed by CAU_CHANNEL_INDEX_*. Channels with records have arrays
// without elements.
#pragma once

#include "cautery/frame_codec.h"
#include "wire/elements.h"

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

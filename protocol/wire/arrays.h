// SPDX-License-Identifier: Apache-2.0
// The channels that are arrays (positions, mask, scalars): what encoder, thinner and decoder keep
// of each as 32-bit words, by CAU_CHANNEL_INDEX_*. Channels with records have arrays of no
// elements.
#pragma once

#include "cautery/frame_codec.h"
#include "wire/elements.h"

enum { POSITION_LIMIT = 1 << 30 }; // steps from the origin

static inline bool cau_stream_has(const cau_stream_def *def, int channel)
{
	return def->channels >> channel & 1;
}

// The channel whose section this is, CAU_CHANNEL_INDEX_*, or CAU_CHANNEL_COUNT.
int cau_channel_of_section(int type);

typedef struct array_shape {
	size_t count; // elements; 0 if the stream has not this channel, or it is no array
	uint32_t components;
	uint32_t bias, most; // of values, see elements_target
} array_shape;

array_shape cau_array_shape_of(const cau_stream_def *def, int channel);

// Words of all arrays together, and scratch that any of them needs.
size_t cau_arrays_words(const cau_stream_def *def);
size_t cau_arrays_scratch_bytes(const cau_stream_def *def);

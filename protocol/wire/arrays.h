// SPDX-License-Identifier: GPL-3.0-or-later
// The array channels of a stream: what encoder and decoder keep of each as 32-bit words.
#pragma once

#include "cautery/frame_codec.h"
#include "wire/elements.h"

// Channels that are arrays, in the order of their sections.
#define ARRAY_TABLE(X)                                                                             \
	X(POSITIONS)                                                                                   \
	X(MASK)                                                                                        \
	X(EXPOSURE)                                                                                    \
	X(CHARRING)                                                                                    \
	X(STRESS)                                                                                      \
	X(TEMPERATURE)

#define X(code) ARRAY_##code,
typedef enum array_index { ARRAY_TABLE(X) ARRAY_COUNT } array_index;
#undef X

enum { POSITION_LIMIT = 1 << 30 }; // steps from the origin

extern const cau_channel cau_array_channel[ARRAY_COUNT];
extern const cau_section cau_array_section[ARRAY_COUNT];

// The array that a section of this type carries, or ARRAY_COUNT.
int cau_array_of_section(int type);

typedef struct array_shape {
	size_t count; // elements; 0 if the stream has not this channel
	uint32_t components;
	uint32_t bias, most; // of values, see elements_target
} array_shape;

array_shape cau_array_shape_of(const cau_stream_def *def, int array);

// Words of all arrays together, and scratch that any of them needs.
size_t cau_arrays_words(const cau_stream_def *def);
size_t cau_arrays_scratch_bytes(const cau_stream_def *def);

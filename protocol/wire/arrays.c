// SPDX-License-Identifier: GPL-3.0-or-later
#include "wire/arrays.h"

array_shape cau_array_shape_of(const cau_stream_def *def, int channel)
{
	array_shape shape = {.count = (size_t)def->vertex_count, .components = 1, .most = UINT8_MAX};
	switch (channel) {
	case CAU_CHANNEL_INDEX_POSITIONS:
		shape.components = 3;
		shape.bias = POSITION_LIMIT;
		shape.most = 2u * POSITION_LIMIT;
		break;
	case CAU_CHANNEL_INDEX_MASK:
		shape.count = ((size_t)def->face_count + 31) / 32;
		shape.most = UINT32_MAX;
		break;
	case CAU_CHANNEL_INDEX_STRESS:
		shape.most = UINT16_MAX;
		break;
	default:
		break;
	}
	if (!(def->channels & 1u << channel))
		shape.count = 0;
	return shape;
}

size_t cau_arrays_words(const cau_stream_def *def)
{
	size_t words = 0;
	for (int channel = 0; channel < ARRAY_COUNT; channel++) {
		array_shape shape = cau_array_shape_of(def, channel);
		words += shape.count * shape.components;
	}
	return words;
}

size_t cau_arrays_scratch_bytes(const cau_stream_def *def)
{
	size_t most = 4;
	for (int channel = 0; channel < ARRAY_COUNT; channel++) {
		array_shape shape = cau_array_shape_of(def, channel);
		size_t bytes = cau_elements_scratch_bytes(shape.count, shape.components);
		most = bytes > most ? bytes : most;
	}
	return most;
}

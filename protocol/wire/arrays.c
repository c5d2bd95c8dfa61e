// SPDX-License-Identifier: GPL-3.0-or-later
#include "wire/arrays.h"

const cau_channel cau_array_channel[ARRAY_COUNT] = {
#define X(code) CAU_CHANNEL_##code,
	ARRAY_TABLE(X)
#undef X
};

const cau_section cau_array_section[ARRAY_COUNT] = {
#define X(code) CAU_SECTION_##code,
	ARRAY_TABLE(X)
#undef X
};

int cau_array_of_section(int type)
{
	int array = 0;
	while (array < ARRAY_COUNT && (int)cau_array_section[array] != type)
		array++;
	return array;
}

array_shape cau_array_shape_of(const cau_stream_def *def, int array)
{
	array_shape shape = {.count = (size_t)def->vertex_count, .components = 1, .most = UINT8_MAX};
	switch (array) {
	case ARRAY_POSITIONS:
		shape.components = 3;
		shape.bias = POSITION_LIMIT;
		shape.most = 2u * POSITION_LIMIT;
		break;
	case ARRAY_MASK:
		shape.count = ((size_t)def->face_count + 31) / 32;
		shape.most = UINT32_MAX;
		break;
	case ARRAY_STRESS:
	case ARRAY_TEMPERATURE:
		shape.most = UINT16_MAX;
		break;
	default:
		break;
	}
	if (!(def->channels & (uint32_t)cau_array_channel[array]))
		shape.count = 0;
	return shape;
}

size_t cau_arrays_words(const cau_stream_def *def)
{
	size_t words = 0;
	for (int array = 0; array < ARRAY_COUNT; array++) {
		array_shape shape = cau_array_shape_of(def, array);
		words += shape.count * shape.components;
	}
	return words;
}

size_t cau_arrays_scratch_bytes(const cau_stream_def *def)
{
	size_t most = 4;
	for (int array = 0; array < ARRAY_COUNT; array++) {
		array_shape shape = cau_array_shape_of(def, array);
		size_t bytes = cau_elements_scratch_bytes(shape.count, shape.components);
		most = bytes > most ? bytes : most;
	}
	return most;
}

// SPDX-License-Identifier: Apache-2.0
#include "wire/arrays.h"

#include "cautery/assert.h"

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

// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "cautery/assert.h"
#include "wire/frame.h"

struct cau_frame_thinner {
	const cau_frame_encoder *encoder;
	uint64_t epoch, sequence; // epoch and sequence of the kept state; epoch 0 means no state
	uint32_t *base[CAU_CHANNEL_COUNT];
	cau_tool_set tools; // tools of the kept state, for their names
};

static size_t struct_bytes(void)
{
	return (sizeof(cau_frame_thinner) + 15) & ~(size_t)15;
}

size_t cau_frame_thinner_bytes(const cau_stream_def *def)
{
	return struct_bytes() + sizeof(uint32_t) * cau_arrays_words(def);
}

cau_status cau_frame_thinner_init(void *storage, size_t storage_bytes,
                                  const cau_frame_encoder *encoder, cau_frame_thinner **thinner,
                                  cau_error *error)
{
	size_t needed = cau_frame_thinner_bytes(&encoder->def);
	if (storage_bytes < needed)
		return cau_fail(error, CAU_LIMIT, NULL, "the thinner needs %zu bytes", needed);
	cau_frame_thinner *made = storage;
	*made = (cau_frame_thinner){.encoder = encoder};
	uint32_t *words = (uint32_t *)(void *)((uint8_t *)storage + struct_bytes());
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		array_shape shape = cau_array_shape_of(&encoder->def, channel);
		made->base[channel] = words;
		words += shape.count * shape.components;
	}
	*thinner = made;
	return CAU_OK;
}

static void keep(cau_frame_thinner *thinner)
{
	CAU_RULE(thinner->encoder->header.sequence % CAU_FRAME_THINNING == 0, "frame %llu is kept",
	         (unsigned long long)thinner->encoder->header.sequence);
	const cau_frame_encoder *encoder = thinner->encoder;
	thinner->epoch = encoder->header.epoch;
	thinner->sequence = encoder->header.sequence;
	thinner->tools = encoder->tools;
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		array_shape shape = cau_array_shape_of(&encoder->def, channel);
		memcpy(thinner->base[channel], encoder->held[channel],
		       sizeof(uint32_t) * shape.count * shape.components);
	}
}

static cau_status thin(cau_frame_thinner *thinner, void *bytes, size_t capacity, size_t *byte_count,
                       cau_error *error)
{
	const cau_frame_encoder *encoder = thinner->encoder;
	uint64_t sequence = encoder->header.sequence;
	*byte_count = 0;
	cau_status status = cau_encoder_check_capacity(encoder, capacity, error);
	if (status || sequence == 0 || sequence % CAU_FRAME_THINNING)
		return status;
	bool follows = thinner->epoch == encoder->header.epoch &&
	               thinner->sequence + CAU_FRAME_THINNING == sequence;
	CAU_RULE(!follows || thinner->sequence < sequence, "frame %llu follows %llu",
	         (unsigned long long)sequence, (unsigned long long)thinner->sequence);
	if (follows) {
		bool names =
			cau_tool_sets_differ(&thinner->tools, encoder->tools.tools, encoder->tools.count);
		*byte_count =
			cau_encoder_write_delta(encoder, thinner->base, thinner->sequence, names, bytes);
	}
	keep(thinner);
	return CAU_OK;
}

cau_status cau_frame_thin(cau_frame_thinner *thinner, void *bytes, size_t capacity,
                          size_t *byte_count, cau_error *error)
{
	cau_rule_guard guard;
	cau_status status;
	cau_rule_enter(&guard);
	if (setjmp(guard.place) == 0)
		status = thin(thinner, bytes, capacity, byte_count, error);
	else
		status = cau_fail(error, CAU_FAULTED, NULL, "%s", guard.reason);
	cau_rule_leave(&guard);
	return status;
}

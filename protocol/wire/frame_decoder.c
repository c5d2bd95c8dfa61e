// SPDX-License-Identifier: Apache-2.0
#include "cautery/frame_codec.h"

#include <string.h>

#include "cautery/assert.h"
#include "wire/frame.h"
#include "wire/records.h"

struct cau_frame_decoder {
	cau_stream_def def;
	cau_stream_state state;
	uint32_t *arrays[CAU_CHANNEL_COUNT];
	cau_stream_tool tools[CAU_MAX_TOOLS];
	cau_vessel_state vessels[CAU_MAX_VESSELS];
	cau_tool_contact contacts[CAU_MAX_TOOLS];
	uint8_t *scratch;
};

static size_t struct_bytes(void)
{
	return (sizeof(cau_frame_decoder) + 15) & ~(size_t)15;
}

size_t cau_frame_decoder_bytes(const cau_stream_def *def)
{
	return struct_bytes() + 4 * cau_arrays_words(def) + cau_arrays_scratch_bytes(def);
}

cau_status cau_frame_decoder_init(void *storage, size_t storage_bytes, const cau_stream_def *def,
                                  cau_frame_decoder **decoder, cau_error *error)
{
	cau_status status = cau_stream_def_check(def, error);
	if (status)
		return status;
	if (storage_bytes < cau_frame_decoder_bytes(def))
		return cau_fail(error, CAU_LIMIT, NULL, "the decoder needs %zu bytes",
		                cau_frame_decoder_bytes(def));
	cau_frame_decoder *made = storage;
	*made = (cau_frame_decoder){.def = *def};
	uint32_t *words = (uint32_t *)(void *)((uint8_t *)storage + struct_bytes());
	memset(words, 0, 4 * cau_arrays_words(def));
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		array_shape shape = cau_array_shape_of(def, channel);
		int scalar = cau_channel_describe((cau_channel_index)channel)->scalar;
		made->arrays[channel] = words;
		if (scalar >= 0)
			made->state.scalar[scalar] = words;
		words += shape.count * shape.components;
	}
	made->scratch = (uint8_t *)words;
	made->state.quantised = (const int32_t *)made->arrays[CAU_CHANNEL_INDEX_POSITIONS];
	made->state.face_mask = made->arrays[CAU_CHANNEL_INDEX_MASK];
	made->state.tools = made->tools;
	made->state.vessels = made->vessels;
	made->state.contacts = made->contacts;
	CAU_ASSERT((size_t)(made->scratch - (uint8_t *)storage) + cau_arrays_scratch_bytes(def) <=
	               storage_bytes,
	           "arrays beyond %zu bytes", storage_bytes);
	*decoder = made;
	return CAU_OK;
}

const cau_stream_state *cau_frame_decoder_state(const cau_frame_decoder *decoder)
{
	return &decoder->state;
}

const cau_stream_def *cau_frame_decoder_def(const cau_frame_decoder *decoder)
{
	return &decoder->def;
}

void cau_frame_decoder_position(const cau_frame_decoder *decoder, double *position)
{
	const cau_stream_def *def = &decoder->def;
	bool present = (def->channels & CAU_CHANNEL_POSITIONS) != 0;
	for (size_t i = 0; i < 3 * (size_t)def->vertex_count; i++)
		position[i] =
			def->origin_m[i % 3] + (present ? def->step_m * decoder->state.quantised[i] : 0.0);
}

// Checks that the frame is the next one for this decoder.
static cau_status check_place(const cau_frame_decoder *decoder, const cau_frame_header *header,
                              cau_error *error)
{
	const cau_stream_state *state = &decoder->state;
	if (header->kind == CAU_FRAME_TOPOLOGY)
		return cau_fail(error, CAU_BAD_STATE, "kind",
		                "the frame is a topology frame, which the frame decoder does not read");
	if (header->session != decoder->def.session)
		return cau_fail(error, CAU_BAD_STATE, "session", "the frame is of session %u, not %u",
		                header->session, decoder->def.session);
	if (header->profile != decoder->def.profile)
		return cau_fail(error, CAU_BAD_STATE, "profile", "the frame is of profile %u, not %u",
		                header->profile, decoder->def.profile);
	if (header->kind == CAU_FRAME_KEY) {
		bool older =
			state->synced && header->epoch == state->epoch && header->sequence <= state->sequence;
		return older ? cau_fail(error, CAU_BAD_STATE, "sequence",
		                        "the key frame is not newer than the frame that the decoder holds")
		             : CAU_OK;
	}
	if (!state->synced)
		return cau_fail(error, CAU_BAD_STATE, NULL, "a key frame is needed first");
	if (header->epoch != state->epoch)
		return cau_fail(error, CAU_BAD_STATE, "epoch",
		                "the frame has another epoch than the decoder");
	if (header->base_sequence != state->sequence)
		return cau_fail(error, CAU_BAD_STATE, "base_sequence",
		                "the frame builds on frame %llu, but the decoder holds frame %llu",
		                (unsigned long long)header->base_sequence,
		                (unsigned long long)state->sequence);
	return header->sequence > header->base_sequence
	           ? CAU_OK
	           : cau_fail(error, CAU_CORRUPT, "sequence",
	                      "the delta is not newer than the frame that it builds on");
}

static void forget(cau_frame_decoder *decoder)
{
	memset(decoder->arrays[0], 0, 4 * cau_arrays_words(&decoder->def));
	decoder->state.tool_count = decoder->state.vessel_count = decoder->state.contact_count = 0;
	decoder->state.statistics = (cau_stream_statistics){0};
}

static const char *read_array(cau_frame_decoder *decoder, const section_cursor *cursor, int channel,
                              bool key)
{
	CAU_ASSERT_INDEX(channel, CAU_CHANNEL_COUNT);
	array_shape shape = cau_array_shape_of(&decoder->def, channel);
	elements_target target = {.values = decoder->arrays[channel],
	                          .count = shape.count,
	                          .components = shape.components,
	                          .bias = shape.bias,
	                          .most = shape.most,
	                          .may_refer_to_held = !key,
	                          .all = key && channel == CAU_CHANNEL_INDEX_POSITIONS};
	size_t count;
	const char *wrong = cau_elements_decode(cursor->payload, cursor->payload_bytes, &target,
	                                        decoder->scratch, &count);
	CAU_ASSERT(wrong || count <= shape.count, "%zu of %zu elements", count, shape.count);
	if (!wrong && channel == CAU_CHANNEL_INDEX_POSITIONS)
		decoder->state.moved_count = (int32_t)count;
	if (!wrong && channel == CAU_CHANNEL_INDEX_MASK)
		decoder->state.mask_changed_count = (int32_t)count;
	return wrong;
}

static bool is_of_tools(int type)
{
	return type == CAU_SECTION_TOOL_NAMES || type == CAU_SECTION_TOOLS_ASKED ||
	       type == CAU_SECTION_TOOL_JAWS || type == CAU_SECTION_TOOL_POWER ||
	       type == CAU_SECTION_TOOL_FORCE;
}

static const char *read_tools(cau_frame_decoder *decoder, const section_cursor *cursor)
{
	const uint8_t *payload = cursor->payload;
	size_t bytes = cursor->payload_bytes;
	int32_t *count = &decoder->state.tool_count;
	switch (cursor->type) {
	case CAU_SECTION_TOOL_NAMES:
		return cau_tool_names_read(payload, bytes, decoder->tools, count);
	case CAU_SECTION_TOOLS_ASKED:
		return cau_tools_asked_read(payload, bytes, decoder->tools, *count);
	case CAU_SECTION_TOOL_JAWS:
		return cau_tool_jaws_read(payload, bytes, decoder->tools, *count);
	case CAU_SECTION_TOOL_POWER:
		return cau_tool_power_read(payload, bytes, decoder->tools, *count);
	case CAU_SECTION_TOOL_FORCE:
		return cau_tool_force_read(payload, bytes, decoder->tools, *count);
	default:
		return cau_tools_read(payload, bytes, decoder->tools, *count);
	}
}

// Reads a section. Sections of unknown channels, and of channels that the stream does not have, are
// skipped.
static const char *read_section(cau_frame_decoder *decoder, const section_cursor *cursor, bool key)
{
	cau_stream_state *state = &decoder->state;
	int channel =
		is_of_tools(cursor->type) ? CAU_CHANNEL_INDEX_TOOLS : cau_channel_of_section(cursor->type);
	if (channel == CAU_CHANNEL_COUNT || !cau_stream_has(&decoder->def, channel))
		return NULL;
	switch (channel) {
	case CAU_CHANNEL_INDEX_TOOLS:
		return read_tools(decoder, cursor);
	case CAU_CHANNEL_INDEX_VESSELS:
		return cau_vessels_read(cursor->payload, cursor->payload_bytes, decoder->vessels,
		                        &state->vessel_count);
	case CAU_CHANNEL_INDEX_TOOL_CONTACT:
		return cau_contacts_read(cursor->payload, cursor->payload_bytes, decoder->contacts,
		                         &state->contact_count);
	case CAU_CHANNEL_INDEX_STATISTICS:
		return cau_statistics_read(cursor->payload, cursor->payload_bytes, &state->statistics);
	default:
		return read_array(decoder, cursor, channel, key);
	}
}

static const char *read_sections(cau_frame_decoder *decoder, const void *bytes,
                                 const cau_frame_header *header)
{
	bool key = header->kind == CAU_FRAME_KEY;
	bool has_positions = !(decoder->def.channels & CAU_CHANNEL_POSITIONS);
	section_cursor cursor = cau_sections_begin(bytes, header);
	while (cau_sections_next(&cursor)) {
		const char *wrong = read_section(decoder, &cursor, key);
		if (wrong)
			return wrong;
		has_positions = has_positions || cursor.type == CAU_SECTION_POSITIONS;
	}
	if (!cursor.wrong && key && !has_positions)
		return "a key frame has no positions";
	return cursor.wrong;
}

cau_status cau_frame_decode(cau_frame_decoder *decoder, const void *bytes, size_t byte_count,
                            cau_error *error)
{
	cau_frame_header header;
	cau_status status = cau_frame_header_read(bytes, byte_count, &header, error);
	if (!status)
		status = check_place(decoder, &header, error);
	if (status)
		return status;
	cau_stream_state *state = &decoder->state;
	if (header.kind == CAU_FRAME_KEY)
		forget(decoder);
	state->moved_count = 0;
	state->mask_changed_count = 0;
	const char *wrong = read_sections(decoder, bytes, &header);
	state->synced = !wrong;
	if (wrong)
		return cau_fail(error, CAU_CORRUPT, "sections", "%s", wrong);
	state->epoch = header.epoch;
	state->sequence = header.sequence;
	state->tick = header.tick;
	state->time_s = header.time_s;
	for (int32_t i = 0; i < state->contact_count; i++)
		decoder->contacts[i].time_s = header.time_s;
	state->published_us = header.published_us;
	state->flags = header.flags;
	return CAU_OK;
}

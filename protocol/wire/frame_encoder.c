// SPDX-License-Identifier: Apache-2.0

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "wire/bytes.h"
#include "wire/frame.h"
#include "wire/records.h"

size_t cau_frame_bytes_max(const cau_stream_def *def)
{
	size_t bytes = CAU_FRAME_HEADER_BYTES;
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		array_shape shape = cau_array_shape_of(def, channel);
		bytes += CAU_FRAME_SECTION_BYTES + cau_elements_bytes_max(shape.count, shape.components);
	}
	return bytes + (size_t)6 * CAU_FRAME_SECTION_BYTES + TOOL_NAMES_BYTES_MAX +
	       (size_t)CAU_MAX_TOOLS * (TOOL_RECORD_BYTES + TOOL_ASKED_BYTES + TOOL_JAW_BYTES +
	                                TOOL_POWER_BYTES + TOOL_FORCE_BYTES) +
	       STATISTICS_RECORD_BYTES +
	       (cau_stream_has(def, CAU_CHANNEL_INDEX_VESSELS) ? VESSELS_BYTES_MAX : 0) +
	       (cau_stream_has(def, CAU_CHANNEL_INDEX_TOOL_CONTACT) ? CONTACTS_BYTES_MAX : 0);
}

static size_t struct_bytes(void)
{
	return (sizeof(cau_frame_encoder) + 15) & ~(size_t)15;
}

size_t cau_frame_encoder_bytes(const cau_stream_def *def)
{
	return struct_bytes() + 2 * sizeof(uint32_t) * cau_arrays_words(def) +
	       cau_arrays_scratch_bytes(def);
}

cau_status cau_frame_encoder_init(void *storage, size_t storage_bytes, const cau_stream_def *def,
                                  uint64_t epoch, cau_frame_encoder **encoder, cau_error *error)
{
	cau_status status = cau_stream_def_check(def, error);
	if (status)
		return status;
	if (epoch == 0)
		return cau_fail(error, CAU_BAD_VALUE, "epoch", "the epoch must not be 0");
	if (storage_bytes < cau_frame_encoder_bytes(def))
		return cau_fail(error, CAU_LIMIT, NULL, "the encoder needs %zu bytes",
		                cau_frame_encoder_bytes(def));
	cau_frame_encoder *made = storage;
	*made = (cau_frame_encoder){.def = *def};
	uint32_t *words = (uint32_t *)(void *)((uint8_t *)storage + struct_bytes());
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		array_shape shape = cau_array_shape_of(def, channel);
		made->held[channel] = words;
		made->next[channel] = words + shape.count * shape.components;
		words += 2 * shape.count * shape.components;
	}
	made->scratch = (uint8_t *)words;
	CAU_ASSERT((size_t)(made->scratch - (uint8_t *)storage) + cau_arrays_scratch_bytes(def) <=
	               storage_bytes,
	           "arrays beyond %zu bytes", storage_bytes);
	cau_frame_encoder_restart(made, epoch);
	*encoder = made;
	return CAU_OK;
}

void cau_frame_encoder_restart(cau_frame_encoder *encoder, uint64_t epoch)
{
	CAU_ASSERT(epoch != 0, "epoch %llu", (unsigned long long)epoch);
	encoder->header = (cau_frame_header){
		.session = encoder->def.session, .profile = encoder->def.profile, .epoch = epoch};
}

uint64_t cau_frame_encoder_epoch(const cau_frame_encoder *encoder)
{
	return encoder->header.epoch;
}

uint64_t cau_frame_encoder_sequence(const cau_frame_encoder *encoder)
{
	return encoder->header.sequence;
}

// ---- taking a sample ----------------------------------------------------------------------------

static bool wants(const cau_frame_encoder *encoder, int channel)
{
	return cau_stream_has(&encoder->def, channel);
}

// Returns the sample's data of a channel, or NULL. A sample may have no tools, no vessels and no
// contacts.
static const void *given(const cau_stream_sample *sample, int channel)
{
	switch (channel) {
	case CAU_CHANNEL_INDEX_POSITIONS:
		return sample->position;
	case CAU_CHANNEL_INDEX_MASK:
		return sample->face_mask;
	case CAU_CHANNEL_INDEX_TOOLS:
	case CAU_CHANNEL_INDEX_VESSELS:
	case CAU_CHANNEL_INDEX_TOOL_CONTACT:
		return sample;
	case CAU_CHANNEL_INDEX_STATISTICS:
		return sample->statistics;
	default:
		return sample->scalar[cau_channel_describe((cau_channel_index)channel)->scalar];
	}
}

static cau_status check_sample(const cau_frame_encoder *encoder, const cau_stream_sample *sample,
                               cau_error *error)
{
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		if (wants(encoder, channel) && !given(sample, channel))
			return cau_fail(error, CAU_BAD_VALUE,
			                cau_channel_describe((cau_channel_index)channel)->name,
			                "the stream has this channel already");
	}
	if (sample->tool_count < 0 || sample->tool_count > CAU_MAX_TOOLS)
		return cau_fail(error, CAU_BAD_VALUE, "tool_count", "%d is not within 0 and %d",
		                sample->tool_count, CAU_MAX_TOOLS);
	for (int32_t i = 0; i < sample->tool_count; i++) {
		const char *wrong = cau_stream_tool_check(&sample->tools[i]);
		if (wrong)
			return cau_fail(error, CAU_BAD_VALUE, "tools", "tool %d: %s", i, wrong);
	}
	if (sample->vessel_count < 0 || sample->vessel_count > CAU_MAX_VESSELS)
		return cau_fail(error, CAU_BAD_VALUE, "vessel_count", "%d is not within 0 and %d",
		                sample->vessel_count, CAU_MAX_VESSELS);
	for (int32_t i = 0; i < sample->vessel_count; i++) {
		const char *wrong = cau_vessel_state_check(sample->vessels[i]);
		if (wrong)
			return cau_fail(error, CAU_BAD_VALUE, "vessels", "vessel %d: %s", i, wrong);
	}
	if (sample->contact_count < 0 || sample->contact_count > CAU_MAX_TOOLS)
		return cau_fail(error, CAU_BAD_VALUE, "contact_count", "%d is not within 0 and %d",
		                sample->contact_count, CAU_MAX_TOOLS);
	for (int32_t i = 0; i < sample->contact_count; i++) {
		const char *wrong = cau_tool_contact_check(&sample->contacts[i]);
		if (wrong)
			return cau_fail(error, CAU_BAD_VALUE, "contacts", "contact %d: %s", i, wrong);
	}
	return isfinite(sample->time_s)
	           ? CAU_OK
	           : cau_fail(error, CAU_NUMERICAL, "time_s", "the time is not finite");
}

// True if a vertex keeps its old position and scalars, because no drawn face uses the vertex. In
// fat, most vertices are hidden in this way. The epoch's first frame has nothing to keep. In a
// stream without the mask no vertex is kept, because readers cannot know which vertices are drawn.
static bool is_kept(const cau_frame_encoder *encoder, const cau_stream_sample *sample,
                    int32_t vertex)
{
	return encoder->header.sequence > 0 && wants(encoder, CAU_CHANNEL_INDEX_MASK) &&
	       sample->vertex_visible && !sample->vertex_visible[vertex];
}

static cau_status quantise_positions(cau_frame_encoder *encoder, const cau_stream_sample *sample,
                                     cau_error *error)
{
	const cau_stream_def *def = &encoder->def;
	uint32_t *next = encoder->next[CAU_CHANNEL_INDEX_POSITIONS];
	const uint32_t *held = encoder->held[CAU_CHANNEL_INDEX_POSITIONS];
	double steps_per_m = 1.0 / def->step_m;
	for (int32_t vertex = 0; vertex < def->vertex_count; vertex++) {
		size_t first = 3 * (size_t)vertex;
		if (is_kept(encoder, sample, vertex)) {
			memcpy(next + first, held + first, 3 * sizeof *next);
			continue;
		}
		for (size_t i = 0; i < 3; i++) {
			double steps = (sample->position[first + i] - def->origin_m[i]) * steps_per_m;
			if (!(fabs(steps) <= POSITION_LIMIT))
				return cau_fail(
					error, CAU_NUMERICAL, "position",
					"vertex %d at %g m is too far from the origin to be sent in steps of %g m",
					vertex, sample->position[first + i], def->step_m);
			next[first + i] = (uint32_t)(int32_t)lrint(steps);
		}
	}
	return CAU_OK;
}

// Converts a scalar to its nearest step, saturated. A value that is not a number becomes 0.
static void quantise_scalar(cau_frame_encoder *encoder, const cau_stream_sample *sample,
                            cau_channel_index channel)
{
	const cau_channel_info *info = cau_channel_describe(channel);
	const float *values = sample->scalar[info->scalar];
	const uint32_t *held = encoder->held[channel];
	uint32_t *next = encoder->next[channel];
	double least = info->least, most = info->most;
	double steps_per_unit = 1.0 / cau_channel_step(&encoder->def, channel);
	CAU_RULE(steps_per_unit > 0 && values, "channel %d: %g steps a unit", (int)channel,
	         steps_per_unit);
	for (int32_t vertex = 0; vertex < encoder->def.vertex_count; vertex++) {
		double steps = ((double)values[vertex] - least) * steps_per_unit;
		steps = steps > 0.0 ? steps : 0.0;
		steps = steps < most ? steps : most;
		next[vertex] = is_kept(encoder, sample, vertex) ? held[vertex] : (uint32_t)lrint(steps);
	}
}

static cau_status take_arrays(cau_frame_encoder *encoder, const cau_stream_sample *sample,
                              cau_error *error)
{
	if (wants(encoder, CAU_CHANNEL_INDEX_POSITIONS)) {
		cau_status status = quantise_positions(encoder, sample, error);
		if (status)
			return status;
	}
	if (wants(encoder, CAU_CHANNEL_INDEX_MASK))
		memcpy(encoder->next[CAU_CHANNEL_INDEX_MASK], sample->face_mask,
		       4 * cau_array_shape_of(&encoder->def, CAU_CHANNEL_INDEX_MASK).count);
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		if (wants(encoder, channel) &&
		    cau_channel_describe((cau_channel_index)channel)->scalar >= 0)
			quantise_scalar(encoder, sample, (cau_channel_index)channel);
	}
	return CAU_OK;
}

bool cau_tool_sets_differ(const cau_tool_set *set, const cau_stream_tool *tools, int32_t count)
{
	CAU_RULE(count >= 0 && count <= CAU_MAX_TOOLS, "%d tools", count);
	bool differ = set->count != count;
	for (int32_t i = 0; i < count && !differ; i++)
		differ = tools[i].shape != set->tools[i].shape ||
		         strncmp(tools[i].name, set->tools[i].name, sizeof tools[i].name) != 0;
	return differ;
}

static bool take_tools(cau_frame_encoder *encoder, const cau_stream_sample *sample)
{
	CAU_RULE(sample->tool_count >= 0 && sample->tool_count <= CAU_MAX_TOOLS, "%d tools",
	         sample->tool_count);
	cau_tool_set *held = &encoder->tools;
	bool renamed = cau_tool_sets_differ(held, sample->tools, sample->tool_count);
	for (int32_t i = 0; i < sample->tool_count; i++)
		held->tools[i] = sample->tools[i];
	held->count = sample->tool_count;
	return renamed;
}

// ---- writing frames

typedef struct frame_writer {
	uint8_t *start;
	uint8_t *at;
	uint16_t section_count;
} frame_writer;

static uint8_t *section_payload(const frame_writer *writer)
{
	return writer->at + CAU_FRAME_SECTION_BYTES;
}

static void end_section(frame_writer *writer, cau_section type, size_t payload_bytes)
{
	CAU_RULE(payload_bytes % 4 == 0, "a section of %zu bytes", payload_bytes);
	cau_section_head_write(writer->at, type, payload_bytes);
	writer->at += CAU_FRAME_SECTION_BYTES + payload_bytes;
	writer->section_count++;
}

// Which part of the present state a frame has: all of it, or the differences from `base`.
typedef struct frame_part {
	uint32_t *const *base; // arrays of a state by channel; NULL for a key frame
	bool names;            // include the names of the tools
} frame_part;

static void write_array(const cau_frame_encoder *encoder, int channel, frame_part part,
                        frame_writer *writer)
{
	array_shape shape = cau_array_shape_of(&encoder->def, channel);
	bool key = part.base == NULL;
	bool positions = channel == CAU_CHANNEL_INDEX_POSITIONS;
	bool mask = channel == CAU_CHANNEL_INDEX_MASK;
	elements_source source = {.now = encoder->held[channel],
	                          .held = key ? NULL : part.base[channel],
	                          .count = shape.count,
	                          .components = shape.components,
	                          .reference = ELEMENTS_HELD,
	                          .all = key && positions,
	                          .plain = encoder->def.plain};
	if (key || mask)
		source.reference = key && positions ? ELEMENTS_PREVIOUS : ELEMENTS_NONE;
	size_t written;
	size_t bytes =
		cau_elements_encode(&source, encoder->scratch, section_payload(writer), &written);
	if (key || written > 0)
		end_section(writer, (cau_section)cau_channel_describe((cau_channel_index)channel)->section,
		            bytes);
}

static void write_tools(const cau_tool_set *set, bool names, frame_writer *writer)
{
	if (names)
		end_section(writer, CAU_SECTION_TOOL_NAMES,
		            cau_tool_names_write(section_payload(writer), set->tools, set->count));
	end_section(writer, CAU_SECTION_TOOLS,
	            cau_tools_write(section_payload(writer), set->tools, set->count));
}

static void write_asked(const cau_tool_set *set, frame_writer *writer)
{
	size_t bytes = cau_tools_asked_write(section_payload(writer), set->tools, set->count);
	if (bytes)
		end_section(writer, CAU_SECTION_TOOLS_ASKED, bytes);
	bytes = cau_tool_jaws_write(section_payload(writer), set->tools, set->count);
	if (bytes)
		end_section(writer, CAU_SECTION_TOOL_JAWS, bytes);
	bytes = cau_tool_power_write(section_payload(writer), set->tools, set->count);
	if (bytes)
		end_section(writer, CAU_SECTION_TOOL_POWER, bytes);
	bytes = cau_tool_force_write(section_payload(writer), set->tools, set->count);
	if (bytes)
		end_section(writer, CAU_SECTION_TOOL_FORCE, bytes);
}

// Writes the channels in the order of their sections. Sections that were added to a channel later
// are last.
static void write_sections(const cau_frame_encoder *encoder, frame_part part, frame_writer *writer)
{
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		if (!wants(encoder, channel))
			continue;
		if (channel == CAU_CHANNEL_INDEX_TOOLS)
			write_tools(&encoder->tools, part.names, writer);
		else if (channel == CAU_CHANNEL_INDEX_VESSELS)
			end_section(writer, CAU_SECTION_VESSELS,
			            cau_vessels_write(section_payload(writer), encoder->vessels,
			                              encoder->vessel_count));
		else if (channel == CAU_CHANNEL_INDEX_TOOL_CONTACT)
			end_section(writer, CAU_SECTION_TOOL_CONTACT,
			            cau_contacts_write(section_payload(writer), encoder->contacts,
			                               encoder->contact_count));
		else if (channel == CAU_CHANNEL_INDEX_STATISTICS)
			end_section(writer, CAU_SECTION_STATISTICS,
			            cau_statistics_write(section_payload(writer), &encoder->statistics));
		else
			write_array(encoder, channel, part, writer);
	}
	if (wants(encoder, CAU_CHANNEL_INDEX_TOOLS))
		write_asked(&encoder->tools, writer);
}

static size_t end_frame(const cau_frame_encoder *encoder, frame_writer *writer, cau_frame_kind kind,
                        uint64_t base_sequence)
{
	CAU_RULE(writer->at >= writer->start + CAU_FRAME_HEADER_BYTES,
	         "a frame shorter than its header, of %u sections", writer->section_count);
	CAU_RULE(base_sequence <= encoder->header.sequence, "frame %llu builds on %llu",
	         (unsigned long long)encoder->header.sequence, (unsigned long long)base_sequence);
	cau_frame_header header = encoder->header;
	header.kind = (uint8_t)kind;
	header.byte_count = (uint32_t)(writer->at - writer->start);
	CAU_RULE(header.byte_count <= cau_frame_bytes_max(&encoder->def),
	         "a frame of %u bytes, at most %zu", header.byte_count,
	         cau_frame_bytes_max(&encoder->def));
	header.base_sequence = base_sequence;
	header.section_count = writer->section_count;
	cau_frame_header_write(writer->start, &header);
	return header.byte_count;
}

cau_status cau_encoder_check_capacity(const cau_frame_encoder *encoder, size_t capacity,
                                      cau_error *error)
{
	size_t needed = cau_frame_bytes_max(&encoder->def);
	return capacity >= needed
	           ? CAU_OK
	           : cau_fail(error, CAU_LIMIT, NULL, "a frame may need %zu bytes", needed);
}

static frame_writer begin_frame(void *bytes)
{
	uint8_t *start = bytes;
	return (frame_writer){.start = start, .at = start + CAU_FRAME_HEADER_BYTES};
}

static size_t write_key(const cau_frame_encoder *encoder, void *bytes)
{
	frame_writer writer = begin_frame(bytes);
	write_sections(encoder, (frame_part){.base = NULL, .names = true}, &writer);
	return end_frame(encoder, &writer, CAU_FRAME_KEY, encoder->header.sequence);
}

size_t cau_encoder_write_delta(const cau_frame_encoder *encoder,
                               uint32_t *const base[CAU_CHANNEL_COUNT], uint64_t base_sequence,
                               bool names, void *bytes)
{
	CAU_RULE(base_sequence < encoder->header.sequence, "frame %llu builds on %llu",
	         (unsigned long long)encoder->header.sequence, (unsigned long long)base_sequence);
	frame_writer writer = begin_frame(bytes);
	write_sections(encoder, (frame_part){.base = base, .names = names}, &writer);
	return end_frame(encoder, &writer, CAU_FRAME_DELTA, base_sequence);
}

static void advance(cau_frame_encoder *encoder, const cau_stream_sample *sample)
{
	for (int channel = 0; channel < CAU_CHANNEL_COUNT; channel++) {
		uint32_t *before = encoder->held[channel];
		encoder->held[channel] = encoder->next[channel];
		encoder->next[channel] = before;
	}
	encoder->header.sequence++;
	encoder->header.tick = sample->tick;
	encoder->header.time_s = sample->time_s;
	encoder->header.published_us = sample->published_us;
	encoder->header.flags = sample->flags;
	if (sample->statistics)
		encoder->statistics = *sample->statistics;
	encoder->vessel_count = sample->vessel_count;
	for (int32_t i = 0; wants(encoder, CAU_CHANNEL_INDEX_VESSELS) && i < sample->vessel_count; i++)
		encoder->vessels[i] = *sample->vessels[i];
	encoder->contact_count =
		wants(encoder, CAU_CHANNEL_INDEX_TOOL_CONTACT) ? sample->contact_count : 0;
	for (int32_t i = 0; i < encoder->contact_count; i++)
		encoder->contacts[i] = sample->contacts[i];
}

static cau_status encode(cau_frame_encoder *encoder, const cau_stream_sample *sample, void *bytes,
                         size_t capacity, size_t *byte_count, cau_error *error)
{
	cau_status status = cau_encoder_check_capacity(encoder, capacity, error);
	if (!status)
		status = check_sample(encoder, sample, error);
	if (!status)
		status = take_arrays(encoder, sample, error);
	if (status)
		return status;
	bool first = encoder->header.sequence == 0;
	bool renamed = take_tools(encoder, sample);
	advance(encoder, sample);
	// Now encoder->next has the previous state, because `advance` swapped it with the present one.
	*byte_count = first ? write_key(encoder, bytes)
	                    : cau_encoder_write_delta(encoder, encoder->next,
	                                              encoder->header.sequence - 1, renamed, bytes);
	return CAU_OK;
}

cau_status cau_frame_encode(cau_frame_encoder *encoder, const cau_stream_sample *sample,
                            void *bytes, size_t capacity, size_t *byte_count, cau_error *error)
{
	cau_rule_guard guard;
	cau_status status;
	cau_rule_enter(&guard);
	if (setjmp(guard.place) == 0)
		status = encode(encoder, sample, bytes, capacity, byte_count, error);
	else
		status = cau_fail(error, CAU_FAULTED, NULL, "%s", guard.reason);
	cau_rule_leave(&guard);
	return status;
}

static cau_status encode_key(const cau_frame_encoder *encoder, void *bytes, size_t capacity,
                             size_t *byte_count, cau_error *error)
{
	cau_status status = cau_encoder_check_capacity(encoder, capacity, error);
	if (status)
		return status;
	if (encoder->header.sequence == 0)
		return cau_fail(error, CAU_BAD_STATE, NULL, "there is no state before the first frame");
	*byte_count = write_key(encoder, bytes);
	return CAU_OK;
}

cau_status cau_frame_encode_key(const cau_frame_encoder *encoder, void *bytes, size_t capacity,
                                size_t *byte_count, cau_error *error)
{
	cau_rule_guard guard;
	cau_status status;
	cau_rule_enter(&guard);
	if (setjmp(guard.place) == 0)
		status = encode_key(encoder, bytes, capacity, byte_count, error);
	else
		status = cau_fail(error, CAU_FAULTED, NULL, "%s", guard.reason);
	cau_rule_leave(&guard);
	return status;
}

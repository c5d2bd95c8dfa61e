// SPDX-License-Identifier: Apache-2.0
#include "cautery/topology_codec.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "wire/frame.h"

enum { CORNERS = 3, TEXTURE_COMPONENTS = 6 };

typedef struct topology_shape {
	size_t faces, vertices;
} topology_shape;

static topology_shape shape_of(const cau_stream_def *def)
{
	return (topology_shape){(size_t)def->face_count, (size_t)def->vertex_count};
}

size_t cau_topology_bytes_max(const cau_stream_def *def)
{
	topology_shape shape = shape_of(def);
	return CAU_FRAME_HEADER_BYTES + (size_t)4 * CAU_FRAME_SECTION_BYTES +
	       cau_elements_bytes_max(shape.faces, CORNERS) + cau_elements_bytes_max(shape.faces, 1) +
	       cau_elements_bytes_max(shape.faces, TEXTURE_COMPONENTS) +
	       cau_elements_bytes_max(shape.vertices, 3);
}

// Returns the size of the scratch memory for the values of one section and for coding these values.
size_t cau_topology_scratch_bytes(const cau_stream_def *def)
{
	topology_shape shape = shape_of(def);
	size_t words = shape.faces * TEXTURE_COMPONENTS;
	words = words > shape.vertices * 3 ? words : shape.vertices * 3;
	return 2 * sizeof(uint32_t) * (words + 1);
}

static uint8_t *coding_scratch(const cau_stream_def *def, void *scratch)
{
	return (uint8_t *)scratch + cau_topology_scratch_bytes(def) / 2;
}

static cau_status check_faces(const cau_stream_def *def, const cau_topology *topology,
                              cau_error *error)
{
	for (size_t i = 0; i < CORNERS * (size_t)def->face_count; i++) {
		if (topology->face[i] < 0 || topology->face[i] >= def->vertex_count)
			return cau_fail(error, CAU_BAD_VALUE, "face", "face %zu has vertex %d of %d",
			                i / CORNERS, topology->face[i], def->vertex_count);
	}
	return CAU_OK;
}

static cau_status quantise_rest(const cau_stream_def *def, const double *position, uint32_t *values,
                                cau_error *error)
{
	for (size_t i = 0; i < 3 * (size_t)def->vertex_count; i++) {
		double steps = (position[i] - def->origin_m[i % 3]) / def->step_m;
		if (!(fabs(steps) <= POSITION_LIMIT))
			return cau_fail(
				error, CAU_NUMERICAL, "rest_position",
				"vertex %zu at %g m is too far from the origin to be sent in steps of %g m", i / 3,
				position[i], def->step_m);
		values[i] = (uint32_t)(int32_t)lrint(steps);
	}
	return CAU_OK;
}

typedef struct topology_writer {
	uint8_t *at;
	uint8_t *scratch; // scratch memory of the coding
	uint16_t section_count;
	bool plain;
} topology_writer;

static void write_section(topology_writer *writer, cau_section type, const uint32_t *values,
                          size_t count, uint32_t components, elements_reference reference)
{
	elements_source source = {.now = values,
	                          .count = count,
	                          .components = components,
	                          .reference = reference,
	                          .all = count > 0,
	                          .plain = writer->plain};
	size_t bytes =
		cau_elements_encode(&source, writer->scratch, writer->at + CAU_FRAME_SECTION_BYTES, NULL);
	CAU_RULE(bytes % 4 == 0 && bytes <= cau_elements_bytes_max(count, components),
	         "a section of %zu bytes", bytes);
	cau_section_head_write(writer->at, type, bytes);
	writer->at += CAU_FRAME_SECTION_BYTES + bytes;
	writer->section_count++;
}

static cau_status write_faces(const cau_stream_def *def, const cau_topology *topology,
                              uint32_t *values, topology_writer *writer, cau_error *error)
{
	cau_status status = check_faces(def, topology, error);
	if (status)
		return status;
	CAU_RULE(def->face_count >= 0, "%d faces", def->face_count);
	size_t faces = (size_t)def->face_count;
	if (faces > 0)
		memcpy(values, topology->face, faces * CORNERS * 4);
	write_section(writer, CAU_SECTION_FACES, values, faces, CORNERS, ELEMENTS_PREVIOUS);
	for (size_t i = 0; i < faces; i++)
		values[i] = topology->face_layer[i];
	write_section(writer, CAU_SECTION_FACE_LAYERS, values, faces, 1, ELEMENTS_NONE);
	if (!topology->texture || faces == 0)
		return CAU_OK;
	memcpy(values, topology->texture, faces * TEXTURE_COMPONENTS * 4);
	write_section(writer, CAU_SECTION_TEXTURE, values, faces, TEXTURE_COMPONENTS, ELEMENTS_NONE);
	return CAU_OK;
}

// Copies faces, layers and texture from a frame that was encoded before.
static cau_status copy_faces(const cau_stream_def *def, const cau_topology *topology,
                             topology_writer *writer, cau_error *error)
{
	cau_frame_header header;
	cau_status status =
		cau_frame_header_read(topology->known, topology->known_bytes, &header, error);
	if (status)
		return status;
	if (header.kind != CAU_FRAME_TOPOLOGY || header.session != def->session)
		return cau_fail(error, CAU_BAD_STATE, "known",
		                "the frame is not a topology frame of this session");
	size_t room = cau_topology_bytes_max(def) - CAU_FRAME_HEADER_BYTES - CAU_FRAME_SECTION_BYTES -
	              cau_elements_bytes_max(shape_of(def).vertices, 3);
	section_cursor cursor = cau_sections_begin(topology->known, &header);
	while (cau_sections_next(&cursor)) {
		if (cursor.type == CAU_SECTION_REST)
			continue;
		size_t bytes = CAU_FRAME_SECTION_BYTES + cursor.payload_bytes;
		if (bytes > room)
			return cau_fail(error, CAU_LIMIT, "known",
			                "the frame has another number of faces than the session");
		room -= bytes;
		cau_section_head_write(writer->at, (cau_section)cursor.type, cursor.payload_bytes);
		memcpy(writer->at + CAU_FRAME_SECTION_BYTES, cursor.payload, cursor.payload_bytes);
		writer->at += bytes;
		writer->section_count++;
	}
	return cursor.wrong ? cau_fail(error, CAU_CORRUPT, "known", "%s", cursor.wrong) : CAU_OK;
}

static cau_status encode(const cau_stream_def *def, uint64_t epoch, const cau_topology *topology,
                         void *scratch, void *bytes, size_t capacity, size_t *byte_count,
                         cau_error *error)
{
	uint32_t *values = scratch;
	topology_writer writer = {(uint8_t *)bytes + CAU_FRAME_HEADER_BYTES,
	                          coding_scratch(def, scratch), 0, def->plain};
	cau_status status = cau_stream_def_check(def, error);
	if (!status && capacity < cau_topology_bytes_max(def))
		status = cau_fail(error, CAU_LIMIT, NULL, "topology may need %zu bytes",
		                  cau_topology_bytes_max(def));
	if (!status)
		status = topology->known ? copy_faces(def, topology, &writer, error)
		                         : write_faces(def, topology, values, &writer, error);
	if (!status)
		status = quantise_rest(def, topology->rest_position, values, error);
	if (status)
		return status;
	write_section(&writer, CAU_SECTION_REST, values, (size_t)def->vertex_count, 3,
	              ELEMENTS_PREVIOUS);
	*byte_count = (size_t)(writer.at - (uint8_t *)bytes);
	cau_frame_header header = {.kind = CAU_FRAME_TOPOLOGY,
	                           .byte_count = (uint32_t)*byte_count,
	                           .session = def->session,
	                           .profile = def->profile,
	                           .epoch = epoch,
	                           .section_count = writer.section_count};
	cau_frame_header_write(bytes, &header);
	return CAU_OK;
}

cau_status cau_topology_encode(const cau_stream_def *def, uint64_t epoch,
                               const cau_topology *topology, void *scratch, void *bytes,
                               size_t capacity, size_t *byte_count, cau_error *error)
{
	cau_rule_guard guard;
	cau_status status;
	cau_rule_enter(&guard);
	if (setjmp(guard.place) == 0)
		status = encode(def, epoch, topology, scratch, bytes, capacity, byte_count, error);
	else
		status = cau_fail(error, CAU_FAULTED, NULL, "%s", guard.reason);
	cau_rule_leave(&guard);
	return status;
}

// ---- reading ------------------------------------------------------------------------------------

static const char *read_layers(const section_cursor *cursor, size_t faces, uint32_t *values,
                               uint8_t *scratch, uint8_t *layers)
{
	elements_target target = {
		.values = values, .count = faces, .components = 1, .most = CAU_MAX_LAYERS - 1, .all = true};
	memset(values, 0, 4 * faces);
	const char *wrong =
		cau_elements_decode(cursor->payload, cursor->payload_bytes, &target, scratch, NULL);
	for (size_t i = 0; i < faces && !wrong; i++)
		layers[i] = (uint8_t)values[i];
	return wrong;
}

static const char *read_section(const cau_stream_def *def, const section_cursor *cursor,
                                void *scratch, cau_topology_arrays *arrays)
{
	topology_shape shape = shape_of(def);
	elements_target target = {.count = shape.faces, .components = CORNERS, .all = true};
	switch (cursor->type) {
	case CAU_SECTION_FACES:
		target.values = (uint32_t *)arrays->face;
		target.most = (uint32_t)def->vertex_count - 1;
		break;
	case CAU_SECTION_FACE_LAYERS:
		return read_layers(cursor, shape.faces, scratch, coding_scratch(def, scratch),
		                   arrays->face_layer);
	case CAU_SECTION_TEXTURE:
		target.values = (uint32_t *)(void *)arrays->texture;
		target.components = TEXTURE_COMPONENTS;
		target.most = UINT32_MAX;
		arrays->has_texture = true;
		break;
	case CAU_SECTION_REST:
		target.values = (uint32_t *)arrays->rest;
		target.count = shape.vertices;
		target.bias = POSITION_LIMIT;
		target.most = 2u * POSITION_LIMIT;
		break;
	default:
		return NULL;
	}
	return cau_elements_decode(cursor->payload, cursor->payload_bytes, &target,
	                           coding_scratch(def, scratch), NULL);
}

static const char *read_sections(const cau_stream_def *def, const void *bytes,
                                 const cau_frame_header *header, void *scratch,
                                 cau_topology_arrays *arrays)
{
	const uint32_t needed =
		1u << CAU_SECTION_FACES | 1u << CAU_SECTION_FACE_LAYERS | 1u << CAU_SECTION_REST;
	uint32_t found = 0;
	section_cursor cursor = cau_sections_begin(bytes, header);
	while (cau_sections_next(&cursor)) {
		const char *wrong = read_section(def, &cursor, scratch, arrays);
		if (wrong)
			return wrong;
		found |= cursor.type < 32 ? 1u << cursor.type : 0;
	}
	if (cursor.wrong)
		return cursor.wrong;
	if ((found & needed) != needed)
		return "faces, their layers or rest positions are missing";
	for (size_t i = 0; arrays->has_texture && i < 6 * (size_t)def->face_count; i++) {
		if (!isfinite(arrays->texture[i]))
			return "a texture coordinate is not finite";
	}
	return NULL;
}

cau_status cau_topology_decode(const cau_stream_def *def, const void *bytes, size_t byte_count,
                               void *scratch, cau_topology_arrays *arrays, cau_error *error)
{
	cau_frame_header header;
	cau_status status = cau_stream_def_check(def, error);
	if (!status)
		status = cau_frame_header_read(bytes, byte_count, &header, error);
	if (status)
		return status;
	if (header.kind != CAU_FRAME_TOPOLOGY || header.session != def->session)
		return cau_fail(error, CAU_BAD_STATE, "session",
		                "the frame is not a topology frame of this session");
	arrays->has_texture = false;
	memset(arrays->texture, 0, sizeof(float) * TEXTURE_COMPONENTS * (size_t)def->face_count);
	const char *wrong = read_sections(def, bytes, &header, scratch, arrays);
	return wrong ? cau_fail(error, CAU_CORRUPT, "sections", "%s", wrong) : CAU_OK;
}

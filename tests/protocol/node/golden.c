// SPDX-License-Identifier: GPL-3.0-or-later
// golden FOLDER: writes streams from the C encoder for the tests in Node, with the state that a
// decoder must have after each frame. Also writes one example of every message.
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/chunk_codec.h"
#include "cautery/defaults.h"
#include "cautery/rpc.h"
#include "cautery/topology_codec.h"
#include "protocol/rpc/messages.h"
#include "protocol/wire/tissue.h"

enum { FRAMES = 40, COLUMNS = 21, ROWS = 17, RESTART_AT = 25, TEXT_BYTES = 1 << 18 };

static const char *folder;

static void check(bool good, const char *what)
{
	if (!good) {
		fprintf(stderr, "golden: %s\n", what);
		exit(EXIT_FAILURE);
	}
}

static FILE *open_file(const char *name)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "wb");
	check(file != NULL, path);
	return file;
}

static void write_bytes(const char *name, const void *bytes, size_t count)
{
	FILE *file = open_file(name);
	check(fwrite(bytes, 1, count, file) == count && fclose(file) == 0, name);
}

// ---- expected states

static void write_signed(FILE *out, const char *key, const int32_t *value, size_t count)
{
	fprintf(out, ",\"%s\":[", key);
	for (size_t i = 0; i < count; i++)
		fprintf(out, "%s%d", i ? "," : "", value[i]);
	fputc(']', out);
}

static void write_unsigned(FILE *out, const char *key, const uint32_t *value, size_t count)
{
	fprintf(out, ",\"%s\":[", key);
	for (size_t i = 0; i < count; i++)
		fprintf(out, "%s%u", i ? "," : "", value[i]);
	fputc(']', out);
}

static void write_floats(FILE *out, const char *key, const double *value, size_t count)
{
	fprintf(out, ",\"%s\":[", key);
	for (size_t i = 0; i < count; i++)
		fprintf(out, "%s%.9g", i ? "," : "", (double)(float)value[i]);
	fputc(']', out);
}

static void write_tool(FILE *out, const cau_stream_tool *tool)
{
	fprintf(out,
	        "{\"name\":\"%s\",\"shape\":%d,\"sequence\":%llu,\"driver\":%u,\"energized\":%s,"
	        "\"grasping\":%s,\"frozen\":%s,\"energyOff\":%d,\"grasped\":%d,\"contacts\":%d,"
	        "\"layers\":%d",
	        tool->name, tool->shape, (unsigned long long)tool->sequence, tool->driver,
	        tool->energized ? "true" : "false", tool->grasping ? "true" : "false",
	        tool->frozen ? "true" : "false", tool->energy_off, tool->grasped_vertices,
	        tool->contact_vertices, tool->touched_layers);
	write_floats(out, "position", tool->pose.position_m, 3);
	write_floats(out, "rotation", tool->pose.rotation, 4);
	write_floats(out, "asked", tool->asked_pose.position_m, 3);
	write_floats(out, "askedRotation", tool->asked_pose.rotation, 4);
	write_floats(out, "jaw", &tool->jaw, 1);
	write_floats(out, "askedJaw", &tool->asked_jaw, 1);
	write_floats(out, "jawForce", &tool->jaw_force_n, 1);
	write_floats(out, "force", tool->force_n, 3);
	write_floats(out, "torque", tool->torque_nm, 3);
	write_floats(out, "temperature", &tool->tip_temperature_c, 1);
	write_floats(out, "energy", &tool->energy_j, 1);
	write_floats(out, "power", &tool->delivered_w, 1);
	write_floats(out, "load", &tool->load_ohm, 1);
	if (tool->has_raw_force) {
		write_floats(out, "rawForce", tool->raw_force_n, 3);
		write_floats(out, "rawTorque", tool->raw_torque_nm, 3);
		write_floats(out, "forceFilter", &tool->force_filter_s, 1);
	}
	fputc('}', out);
}

static void write_vessel(FILE *out, const cau_vessel_state *vessel)
{
	const double scalars[] = {vessel->radius_m, vessel->bleeding_m3_s, vessel->shed_m3,
	                          vessel->burst_pa};
	double points[4 * CAU_VESSEL_SHOWN_POINTS];
	for (int32_t i = 0; i < vessel->point_count; i++) {
		for (int c = 0; c < 3; c++)
			points[4 * i + c] = (double)vessel->point[i].position_m[c];
		points[4 * i + 3] = (double)vessel->point[i].open;
	}
	fprintf(out, "{\"name\":\"%s\",\"flags\":%u", vessel->name, vessel->flags);
	write_floats(out, "scalars", scalars, 4);
	write_floats(out, "points", points, 4 * (size_t)vessel->point_count);
	fputc('}', out);
}

static void write_contact(FILE *out, const cau_tool_contact *contact)
{
	double planes[5 * CAU_CONTACT_PLANES];
	for (int32_t i = 0; i < contact->plane_count; i++) {
		memcpy(planes + (ptrdiff_t)5 * i, contact->plane[i].normal,
		       sizeof contact->plane[i].normal);
		planes[5 * i + 3] = contact->plane[i].offset_m;
		planes[5 * i + 4] = contact->plane[i].velocity_m_s;
	}
	const double scalars[] = {contact->friction, contact->damping_ns_m, contact->grasp_n_m};
	fprintf(out, "{\"name\":\"%s\",\"valid\":%s", contact->name, contact->valid ? "true" : "false");
	write_floats(out, "asked", contact->asked_pose.position_m, 3);
	write_floats(out, "askedRotation", contact->asked_pose.rotation, 4);
	write_floats(out, "position", contact->pose.position_m, 3);
	write_floats(out, "rotation", contact->pose.rotation, 4);
	write_floats(out, "force", contact->force_n, 3);
	write_floats(out, "compliance", contact->compliance_m_n, 6);
	write_floats(out, "scalars", scalars, 3);
	write_floats(out, "anchor", contact->grasp_anchor_m, 3);
	write_floats(out, "planes", planes, 5 * (size_t)contact->plane_count);
	fputc('}', out);
}

static void write_state(FILE *out, const cau_frame_decoder *decoder)
{
	const cau_stream_state *state = cau_frame_decoder_state(decoder);
	const cau_stream_def *def = cau_frame_decoder_def(decoder);
	size_t vertices = (size_t)def->vertex_count;
	fprintf(out, "{\"epoch\":\"%016llx\",\"sequence\":%llu,\"tick\":%llu,\"time\":%.17g",
	        (unsigned long long)state->epoch, (unsigned long long)state->sequence,
	        (unsigned long long)state->tick, state->time_s);
	write_signed(out, "quantised", state->quantised, 3 * vertices);
	write_unsigned(out, "mask", state->face_mask, ((size_t)def->face_count + 31) / 32);
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		if (info->scalar >= 0)
			write_unsigned(out, info->name, state->scalar[info->scalar], vertices);
	}
	fprintf(out, ",\"iterations\":%u,\"contacts\":%u,\"tools\":[", state->statistics.iterations,
	        state->statistics.contacts);
	for (int32_t i = 0; i < state->tool_count; i++) {
		fputs(i ? "," : "", out);
		write_tool(out, &state->tools[i]);
	}
	fputs("],\"vessels\":[", out);
	for (int32_t i = 0; i < state->vessel_count; i++) {
		fputs(i ? "," : "", out);
		write_vessel(out, &state->vessels[i]);
	}
	fputs("],\"toolContacts\":[", out);
	for (int32_t i = 0; i < state->contact_count; i++) {
		fputs(i ? "," : "", out);
		write_contact(out, &state->contacts[i]);
	}
	fputs("]}", out);
}

// ---- streams

typedef struct recording {
	FILE *manifest;
	int number; // number of the stream
	int frames;
	tissue tissue;
	cau_stream_def def;
	cau_frame_encoder *encoder;
	cau_frame_decoder *decoder;
	uint8_t *bytes;
	size_t capacity;
} recording;

// Writes a frame. `expect` is the required result of a decoder: "ok", "refused" (state kept) or
// "corrupt" (state lost).
static void record(recording *of, const uint8_t *bytes, size_t count, const char *expect)
{
	char name[64];
	snprintf(name, sizeof name, "stream%d-%03d.bin", of->number, of->frames);
	write_bytes(name, bytes, count);
	fprintf(of->manifest, "%s\n{\"file\":\"%s\",\"expect\":\"%s\"", of->frames++ ? "," : "", name,
	        expect);
	if (strcmp(expect, "ok") == 0) {
		check(cau_frame_decode(of->decoder, bytes, count, NULL) == CAU_OK, "own frame");
		fputs(",\"state\":", of->manifest);
		write_state(of->manifest, of->decoder);
	}
	fputc('}', of->manifest);
}

static size_t encode(recording *of, int32_t tick, double speed_m_s)
{
	size_t count;
	tissue_move(&of->tissue, tick, speed_m_s);
	// Some vertices are hidden for a while.
	for (int32_t v = 0; v < of->tissue.vertex_count; v++)
		of->tissue.visible[v] = (v + tick) % 13 != 0;
	cau_stream_sample sample = tissue_sample(&of->tissue);
	check(cau_frame_encode(of->encoder, &sample, of->bytes, of->capacity, &count, NULL) == CAU_OK,
	      "encode");
	return count;
}

static void open_recording(recording *of, bool plain)
{
	tissue_init(&of->tissue, COLUMNS, ROWS);
	of->def = tissue_stream_def(&of->tissue);
	of->def.plain = plain;
	of->def.origin_m[0] = -0.125;
	of->def.step_m = 2.5e-5;
	size_t encoder_bytes = cau_frame_encoder_bytes(&of->def);
	size_t decoder_bytes = cau_frame_decoder_bytes(&of->def);
	of->capacity = cau_frame_bytes_max(&of->def);
	of->bytes = malloc(of->capacity);
	check(cau_frame_encoder_init(malloc(encoder_bytes), encoder_bytes, &of->def, 0xfedcba9876543210,
	                             &of->encoder, NULL) == CAU_OK,
	      "encoder");
	check(cau_frame_decoder_init(malloc(decoder_bytes), decoder_bytes, &of->def, &of->decoder,
	                             NULL) == CAU_OK,
	      "decoder");
}

// Records a key frame and deltas. It adds a frame of another epoch, a repeated frame and a late key
// frame, which must be refused. Then come a restart with another epoch, a damaged frame, and the
// key frame that repairs the state.
static void record_stream(FILE *manifest, int number, double speed_m_s, bool plain)
{
	recording of = {.manifest = manifest, .number = number};
	uint8_t *late;
	size_t count, late_count = 0;
	open_recording(&of, plain);
	late = malloc(of.capacity);
	for (int32_t tick = 0; tick < FRAMES; tick++) {
		if (tick == RESTART_AT) {
			late_count = encode(&of, tick, speed_m_s);
			memcpy(late, of.bytes, late_count);
			cau_frame_encoder_restart(of.encoder, 0x1111222233334444 + (uint64_t)number);
		}
		count = encode(&of, tick, speed_m_s);
		record(&of, of.bytes, count, "ok");
		if (tick == 3)
			record(&of, of.bytes, count, "refused");
		if (tick == RESTART_AT)
			record(&of, late, late_count, "refused");
		if (tick == 10) {
			check(cau_frame_encode_key(of.encoder, late, of.capacity, &late_count, NULL) == CAU_OK,
			      "key frame");
			record(&of, late, late_count, "refused");
		}
	}
	count = encode(&of, FRAMES, speed_m_s);
	of.bytes[CAU_FRAME_HEADER_BYTES + CAU_FRAME_SECTION_BYTES + 1] = 2; // number of components
	record(&of, of.bytes, count, "corrupt");
	check(cau_frame_encode_key(of.encoder, of.bytes, of.capacity, &count, NULL) == CAU_OK,
	      "key frame");
	record(&of, of.bytes, count, "ok");
	free(late);
	free(of.bytes);
	free(of.encoder);
	free(of.decoder);
	tissue_finish(&of.tissue);
}

static void write_streams(void)
{
	static const double speeds[] = {0.003, 0.2, 10.0, 9000.0};
	FILE *manifest = open_file("streams.json");
	tissue of;
	tissue_init(&of, COLUMNS, ROWS);
	fprintf(manifest,
	        "{\"session\":3,\"profile\":1,\"vertexCount\":%d,\"faceCount\":%d,\"streams\":[",
	        of.vertex_count, of.face_count);
	tissue_finish(&of);
	for (int i = 0; i < 8; i++) {
		fprintf(manifest, "%s\n{\"plain\":%s,\"frames\":[", i ? "," : "", i < 4 ? "false" : "true");
		record_stream(manifest, i, speeds[i % 4], i >= 4);
		fputs("]}", manifest);
	}
	fputs("]}\n", manifest);
	check(fclose(manifest) == 0, "streams.json");
}

// ---- topology and chunks

static void fill_faces(const tissue *of, int32_t *face, uint8_t *layer, float *texture)
{
	for (int32_t f = 0; f < of->face_count; f++) {
		int32_t cell = f / 2;
		int32_t corner = cell / (COLUMNS - 1) * COLUMNS + cell % (COLUMNS - 1);
		face[3 * f] = corner + (f % 2 ? COLUMNS : 0);
		face[3 * f + 1] = corner + 1;
		face[3 * f + 2] = corner + COLUMNS + f % 2;
		layer[f] = (uint8_t)(f % 3);
		for (int i = 0; i < 6; i++)
			texture[6 * f + i] = 0.1f * (float)(f - i);
	}
}

static void write_topology(void)
{
	tissue of;
	tissue_init(&of, COLUMNS, ROWS);
	cau_stream_def def = tissue_stream_def(&of);
	size_t faces = (size_t)of.face_count, capacity = cau_topology_bytes_max(&def), count;
	int32_t *face = calloc(3 * faces, 4), *rest = calloc(3 * (size_t)of.vertex_count, 4);
	uint8_t *layer = calloc(faces, 1), *bytes = malloc(capacity);
	float *texture = calloc(6 * faces, sizeof *texture);
	void *scratch = malloc(cau_topology_scratch_bytes(&def));
	fill_faces(&of, face, layer, texture);
	cau_topology topology = {
		.face = face, .face_layer = layer, .texture = texture, .rest_position = of.position};
	check(cau_topology_encode(&def, 1, &topology, scratch, bytes, capacity, &count, NULL) == CAU_OK,
	      "topology");
	write_bytes("topology.bin", bytes, count);
	cau_topology_arrays arrays = {face, layer, texture, rest, false};
	check(cau_topology_decode(&def, bytes, count, scratch, &arrays, NULL) == CAU_OK, "topology");
	FILE *file = open_file("topology.json");
	fprintf(file, "{\"layer0\":%d", layer[0]);
	write_signed(file, "faces", face, 3 * faces);
	write_signed(file, "rest", rest, 3 * (size_t)of.vertex_count);
	fputs(",\"layers\":[", file);
	for (size_t f = 0; f < faces; f++)
		fprintf(file, "%s%d", f ? "," : "", layer[f]);
	fputs("],\"texture\":[", file);
	for (size_t i = 0; i < 6 * faces; i++)
		fprintf(file, "%s%.9g", i ? "," : "", (double)texture[i]);
	fputs("]}\n", file);
	check(fclose(file) == 0, "topology.json");
	free(face);
	free(rest);
	free(layer);
	free(bytes);
	free(texture);
	free(scratch);
	tissue_finish(&of);
}

// ---- messages

static void write_line(FILE *out, const char *message, cau_status status,
                       const cau_rpc_buffer *text)
{
	check(status == CAU_OK, message);
	fprintf(out, "{\"message\":\"%s\",\"payload\":%s}\n", message, text->buffer);
}

static void write_plain(FILE *out, cau_method method, fill how, cau_scene_def *scene,
                        cau_rpc_buffer *text)
{
	const cau_method_info *info = cau_method_describe(method);
	void *params = calloc(1, cau_wire_shapes[info->params].bytes);
	bool request = info->form == CAU_FORM_REQUEST || info->form == CAU_FORM_EITHER_WAY;
	fill_message(info->params, params, how, scene);
	write_line(out, info->name,
	           request ? cau_rpc_write_request(text, 5, method, params, NULL)
	                   : cau_rpc_write_notification(text, method, params, NULL),
	           text);
	release_message(info->params, params);
	free(params);
}

static void write_command(FILE *out, const cau_method_info *info, int layer_kind,
                          cau_rpc_buffer *text)
{
	int kind = info->command;
	int64_t id = 8;
	cau_rpc_envelope envelope = {true, "d1-demo", true, 4};
	cau_command command;
	cau_default_command(&command, kind);
	if (kind == CAU_COMMAND_TOOL_ADD)
		strcpy(command.as.definition.name, "hook");
	else if (kind <= CAU_COMMAND_TOOL_RELEASE || kind == CAU_COMMAND_TOOL_HOLD)
		strcpy(command.tool, "hook");
	if (kind == CAU_COMMAND_SET_MATERIAL) {
		strcpy(command.as.material.layer, "skin");
		command.as.material.kind = layer_kind;
	}
	write_line(out, info->name, cau_rpc_write_command(text, &id, &envelope, &command, NULL), text);
}

static void write_result(FILE *out, cau_method method, fill how, cau_scene_def *scene,
                         cau_rpc_buffer *text)
{
	const cau_method_info *info = cau_method_describe(method);
	char name[64];
	cau_rpc_id id = {.kind = CAU_RPC_ID_TEXT, .text = "five"};
	void *result = calloc(1, cau_wire_shapes[info->result].bytes);
	fill_message(info->result, result, how, scene);
	snprintf(name, sizeof name, "%s.result", info->name);
	write_line(out, name, cau_rpc_write_result(text, &id, method, result, NULL), text);
	release_message(info->result, result);
	free(result);
}

static void write_method(FILE *out, cau_method method, cau_scene_def *scene, cau_rpc_buffer *text)
{
	const cau_method_info *info = cau_method_describe(method);
	for (int how = FILL_LEAST; how <= FILL_MOST; how++) {
		if (info->command < 0)
			write_plain(out, method, (fill)how, scene, text);
		if (info->form == CAU_FORM_REQUEST || info->form == CAU_FORM_EITHER_WAY)
			write_result(out, method, (fill)how, scene, text);
	}
	int variants = info->command == CAU_COMMAND_SET_MATERIAL ? CAU_LAYER_COUNT : 1;
	for (int kind = 0; kind < variants && info->command >= 0; kind++)
		write_command(out, info, kind, text);
}

static void write_messages(void)
{
	static char buffer[TEXT_BYTES];
	static cau_scene_def scene;
	cau_rpc_buffer text = {buffer, sizeof buffer, 0};
	FILE *out = open_file("messages.jsonl");
	cau_rpc_id none = {.kind = CAU_RPC_ID_NONE};
	cau_rpc_fault fault;
	cau_default_scene_def(&scene);
	strcpy(scene.name, "empty");
	for (int method = 0; method < CAU_METHOD_COUNT; method++)
		write_method(out, (cau_method)method, &scene, &text);
	cau_rpc_fault_of_code(&fault, CAU_RPC_PARSE, "line 1");
	write_line(out, "error", cau_rpc_write_error(&text, &none, &fault, NULL), &text);
	check(fclose(out) == 0, "messages.jsonl");
}

int main(int argument_count, char **arguments)
{
	check(argument_count == 2, "usage: golden FOLDER");
	folder = arguments[1];
	write_streams();
	write_topology();
	write_messages();
	return EXIT_SUCCESS;
}

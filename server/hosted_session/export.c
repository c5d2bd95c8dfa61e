// SPDX-License-Identifier: GPL-3.0-or-later
// Files made of a session: the tissue for other programs, the log as a script.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "buffer/sha256.h"
#include "cautery/command_json.h"
#include "hosted_session/internal.h"

static atomic_uint last_transfer;

// Answers with the transfer and hands the file to the transport, which sends it in chunks.
static void answer_file(cau_hosted *h, cau_order *order, const char *bytes, size_t byte_count,
                        const char *ending, const char *media_type)
{
	cau_error error = {0};
	cau_buffer *file = cau_buffer_create(byte_count, true);
	cau_wire_transfer result = {.transfer = ++last_transfer, .byte_count = (int64_t)byte_count};
	cau_outcome outcome = {.file = file, .transfer = (uint32_t)result.transfer};
	char *text = NULL;
	snprintf(result.file_name, sizeof result.file_name, "%s-%llu.%s", h->id,
	         (unsigned long long)h->tick, ending);
	snprintf(result.media_type, sizeof result.media_type, "%s", media_type);
	if (file && cau_sha256(bytes, byte_count, result.sha256)) {
		memcpy(cau_buffer_bytes(file), bytes, byte_count);
		text = cau_answer_text(order->reply.method, &result, &outcome.text_bytes, &error);
	} else {
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory for the file");
	}
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(&order->reply, &outcome);
	cau_buffer_release(file);
	free(text);
	free(order);
}

static bool is_drawn(const cau_frame *frame, int32_t face)
{
	return !(frame->face_mask[face / 32] >> (face % 32) & 1);
}

static void write_obj(const cau_hosted *h, const cau_frame *frame, FILE *stream)
{
	fprintf(stream, "# %s at tick %llu, metres\n", h->id, (unsigned long long)frame->tick);
	for (int32_t v = 0; v < h->info.vertex_count; v++)
		fprintf(stream, "v %.9g %.9g %.9g\n", frame->position[3 * v], frame->position[3 * v + 1],
		        frame->position[3 * v + 2]);
	for (int32_t layer = 0; layer < h->info.layer_count; layer++) {
		const cau_session_layer *part = &h->info.layers[layer];
		if (part->face_count)
			fprintf(stream, "g %s\n", part->name);
		for (int32_t f = part->first_face; f < part->first_face + part->face_count; f++)
			if (is_drawn(frame, f))
				fprintf(stream, "f %d %d %d\n", h->info.face[3 * f] + 1,
				        h->info.face[3 * f + 1] + 1, h->info.face[3 * f + 2] + 1);
	}
}

// The cells that are left: tetrahedra, then drawn faces of sheets.
typedef struct cells {
	int32_t *vertex; // 4 each, -1 in a triangle's last
	int32_t count;
} cells;

static bool is_sheet_face(const cau_hosted *h, int32_t face)
{
	return h->info.layers[h->info.face_layer[face]].kind != CAU_LAYER_FAT;
}

static bool collect_cells(const cau_hosted *h, const cau_frame *frame, cells *out)
{
	const uint8_t *tetrahedron, *triangle, *link;
	size_t most = (size_t)h->info.tetrahedron_count + (size_t)h->info.face_count + 1;
	cau_session_alive(h->core, &tetrahedron, &triangle, &link);
	out->vertex = malloc(most * 4 * sizeof *out->vertex);
	if (!out->vertex)
		return false;
	for (int32_t i = 0; i < h->info.tetrahedron_count; i++)
		if (tetrahedron[i])
			memcpy(&out->vertex[4 * out->count++], &h->info.tetrahedron[4 * i],
			       4 * sizeof(int32_t));
	for (int32_t f = 0; f < h->info.face_count; f++) {
		if (!is_drawn(frame, f) || !is_sheet_face(h, f))
			continue;
		memcpy(&out->vertex[4 * out->count], &h->info.face[3 * f], 3 * sizeof(int32_t));
		out->vertex[4 * out->count++ + 3] = -1;
	}
	return true;
}

static void write_array(FILE *stream, const char *type, const char *name, int components)
{
	fprintf(stream,
	        "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\">\n",
	        type, name, components);
}

static void write_points(const cau_hosted *h, const cau_frame *frame, FILE *stream)
{
	fputs("<Points>\n", stream);
	write_array(stream, "Float64", "position_m", 3);
	for (int32_t v = 0; v < h->info.vertex_count; v++)
		fprintf(stream, "%.9g %.9g %.9g\n", frame->position[3 * v], frame->position[3 * v + 1],
		        frame->position[3 * v + 2]);
	fputs("</DataArray>\n</Points>\n<PointData>\n", stream);
	write_array(stream, "Float32", "exposure", 1);
	for (int32_t v = 0; v < h->info.vertex_count; v++)
		fprintf(stream, "%.6g\n", (double)frame->exposure[v]);
	fputs("</DataArray>\n</PointData>\n", stream);
}

static void write_cells(const cells *list, FILE *stream)
{
	enum { VTK_TRIANGLE = 5, VTK_TETRA = 10 };
	fputs("<Cells>\n", stream);
	write_array(stream, "Int32", "connectivity", 1);
	for (int32_t i = 0; i < list->count; i++) {
		const int32_t *v = &list->vertex[4 * i];
		fprintf(stream, v[3] < 0 ? "%d %d %d\n" : "%d %d %d %d\n", v[0], v[1], v[2], v[3]);
	}
	fputs("</DataArray>\n", stream);
	write_array(stream, "Int32", "offsets", 1);
	for (int32_t i = 0, end = 0; i < list->count; i++)
		fprintf(stream, "%d\n", end += list->vertex[4 * i + 3] < 0 ? 3 : 4);
	fputs("</DataArray>\n", stream);
	write_array(stream, "UInt8", "types", 1);
	for (int32_t i = 0; i < list->count; i++)
		fprintf(stream, "%d\n", list->vertex[4 * i + 3] < 0 ? VTK_TRIANGLE : VTK_TETRA);
	fputs("</DataArray>\n</Cells>\n", stream);
}

static void write_vtu(const cau_hosted *h, const cau_frame *frame, const cells *list, FILE *stream)
{
	fprintf(stream,
	        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
	        "byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"%d\" "
	        "NumberOfCells=\"%d\">\n",
	        h->info.vertex_count, list->count);
	write_points(h, frame, stream);
	write_cells(list, stream);
	fputs("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", stream);
}

static void fail(cau_order *order, cau_status status, const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, status, "", "%s", reason);
	cau_answer_fail(order, &error, 0);
}

void cau_apply_export(cau_hosted *h, cau_order *order)
{
	char *bytes = NULL;
	size_t count = 0;
	cau_frame frame;
	cells list = {0};
	bool vtu = order->as.format == CAU_EXPORT_VTU;
	FILE *stream = open_memstream(&bytes, &count);
	cau_session_frame(h->core, &frame);
	bool done = stream && (!vtu || collect_cells(h, &frame, &list));
	if (done && vtu)
		write_vtu(h, &frame, &list, stream);
	else if (done)
		write_obj(h, &frame, stream);
	if (stream)
		done = fclose(stream) == 0 && done;
	if (done)
		answer_file(h, order, bytes, count, vtu ? "vtu" : "obj",
		            vtu ? "application/xml" : "model/obj");
	else
		fail(order, CAU_NO_MEMORY, "no memory for the file");
	free(list.vertex);
	free(bytes);
}

static cau_status write_line(void *user, const cau_store_command *row)
{
	char json[CAU_COMMAND_JSON_MAX_BYTES];
	size_t bytes = 0;
	cau_command command;
	cau_error error;
	cau_status status =
		cau_command_from_json(row->payload.data, row->payload.bytes, &command, &error);
	if (!status && command.tick < row->tick)
		command.tick = row->tick;
	if (!status)
		status = cau_command_to_json(&command, json, sizeof json, &bytes, &error);
	if (!status && fprintf(user, "%s\n", json) < 0)
		status = CAU_NO_MEMORY;
	return status;
}

void cau_apply_log(cau_hosted *h, cau_order *order)
{
	char *bytes = NULL;
	size_t count = 0;
	cau_error error = {.reason = "no memory for the log"};
	uint64_t to = order->as.log.to_tick < h->tick ? order->as.log.to_tick : h->tick;
	FILE *stream = open_memstream(&bytes, &count);
	cau_record_commit(h);
	cau_store_flush(h->around->store);
	cau_status status =
		stream ? cau_store_read_log(h->around->store, h->id, h->branch, order->as.log.from_tick,
	                                to + 1, write_line, stream, &error)
			   : CAU_NO_MEMORY;
	if (stream && fclose(stream))
		status = CAU_NO_MEMORY;
	if (status)
		fail(order, status, error.reason);
	else
		answer_file(h, order, bytes, count, "jsonl", "application/jsonl");
	free(bytes);
}

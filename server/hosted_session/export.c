// SPDX-License-Identifier: GPL-3.0-or-later
// Makes files of a session: the tissue for other programs, and the log as a script. At a tick
// border the worker copies what steps change. The builder then writes the file from the copy.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/command_json.h"
#include "cautery/sha256.h"
#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

#define LINE_S 1e-6 // estimated time to write one line of the file, s
// estimated time to write a log, s; its length is known only after reading
#define LOG_EXPECTED_S 0.1

static atomic_uint last_transfer;

uint32_t cau_export_number(void)
{
	return ++last_transfer;
}

void cau_hosted_answer_file(const cau_reply *reply, const char *name, const char *media_type,
                            const void *bytes, size_t byte_count)
{
	cau_error error = {0};
	cau_buffer *file = cau_buffer_create(byte_count, true);
	cau_wire_transfer result = {.transfer = cau_export_number(), .byte_count = (int64_t)byte_count};
	cau_outcome outcome = {.file = file, .transfer = (uint32_t)result.transfer};
	char *text = NULL;
	snprintf(result.file_name, sizeof result.file_name, "%s", name);
	snprintf(result.media_type, sizeof result.media_type, "%s", media_type);
	if (file && cau_sha256(bytes, byte_count, result.sha256)) {
		memcpy(cau_buffer_bytes(file), bytes, byte_count);
		text = cau_answer_text(reply->method, &result, &outcome.text_bytes, &error);
	} else {
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory for the file");
	}
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(reply, &outcome);
	cau_buffer_release(file);
	free(text);
}

static void answer_file(const cau_read_job *job, const char *bytes, size_t byte_count,
                        const char *ending, const char *media_type)
{
	char name[CAU_NAME_BYTES + 40];
	snprintf(name, sizeof name, "%s-%llu.%s", job->hosted->identity.id,
	         (unsigned long long)job->tick, ending);
	cau_hosted_answer_file(&job->order->reply, name, media_type, bytes, byte_count);
}

static void fail(const cau_reply *reply, cau_status status, const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, status, "", "%s", reason);
	cau_reply_fail(reply, &error, 0);
}

// ---- the copy
// The data of one tick that an exported file shows. The arrays follow the struct in the same memory
// block.
typedef struct tissue_copy {
	const double *position; // m, (vertex_count x 3)
	const float *exposure;  // (vertex_count)
	const uint32_t *mask;   // ((face_count + 31) / 32)
	const uint8_t *alive;   // (tetrahedron_count)
} tissue_copy;

// Sizes of the arrays in their order, bytes. Arrays of wider numbers come first, so that each is
// aligned.
typedef struct copy_sizes {
	size_t position, exposure, mask, alive;
} copy_sizes;

static copy_sizes sizes_of(const cau_session_info *info)
{
	size_t vertices = (size_t)info->vertex_count, faces = (size_t)info->face_count;
	return (copy_sizes){.position = vertices * 3 * sizeof(double),
	                    .exposure = vertices * sizeof(float),
	                    .mask = (faces + 31) / 32 * sizeof(uint32_t),
	                    .alive = (size_t)info->tetrahedron_count};
}

size_t cau_export_copy_bytes(const cau_session_info *info)
{
	copy_sizes sizes = sizes_of(info);
	return sizeof(tissue_copy) + sizes.position + sizes.exposure + sizes.mask + sizes.alive;
}

static void *copy_to(unsigned char **at, const void *source, size_t bytes)
{
	void *copy = *at;
	if (bytes)
		memcpy(copy, source, bytes);
	*at += bytes;
	return copy;
}

static tissue_copy *copy_tissue(const cau_present_core *core, cau_shelf *copies)
{
	const uint8_t *tetrahedron, *triangle, *link;
	copy_sizes sizes = sizes_of(&core->info);
	cau_frame frame;
	tissue_copy *copy = cau_shelf_take(copies, cau_export_copy_bytes(&core->info));
	if (!copy)
		return NULL;
	unsigned char *at = (unsigned char *)(copy + 1);
	cau_session_frame(core->session, &frame);
	cau_session_alive(core->session, &tetrahedron, &triangle, &link);
	copy->position = copy_to(&at, frame.position, sizes.position);
	copy->exposure = copy_to(&at, frame.exposure, sizes.exposure);
	copy->mask = copy_to(&at, frame.face_mask, sizes.mask);
	copy->alive = copy_to(&at, tetrahedron, sizes.alive);
	return copy;
}

// ---- the file. `info` never changes, so any thread may read it.
static bool is_drawn(const tissue_copy *copy, int32_t face)
{
	return !(copy->mask[face / 32] >> (face % 32) & 1);
}

static void write_obj(const cau_read_job *job, FILE *stream)
{
	const cau_session_info *info = &job->hosted->core.info;
	const tissue_copy *copy = job->copy;
	fprintf(stream, "# %s at tick %llu, metres\n", job->hosted->identity.id,
	        (unsigned long long)job->tick);
	for (int32_t v = 0; v < info->vertex_count; v++)
		fprintf(stream, "v %.9g %.9g %.9g\n", copy->position[3 * v], copy->position[3 * v + 1],
		        copy->position[3 * v + 2]);
	for (int32_t layer = 0; layer < info->layer_count; layer++) {
		const cau_session_layer *part = &info->layers[layer];
		if (part->face_count)
			fprintf(stream, "g %s\n", part->name);
		for (int32_t f = part->first_face; f < part->first_face + part->face_count; f++)
			if (is_drawn(copy, f))
				fprintf(stream, "f %d %d %d\n", info->face[3 * f] + 1, info->face[3 * f + 1] + 1,
				        info->face[3 * f + 2] + 1);
	}
}

// The cells of the tissue that are left: tetrahedra, then drawn faces of sheets.
typedef struct cells {
	int32_t *vertex; // 4 vertices for each cell; the last one of a triangle is -1
	int32_t count;
} cells;

static bool is_sheet_face(const cau_session_info *info, int32_t face)
{
	return info->layers[info->face_layer[face]].kind != CAU_LAYER_FAT;
}

static bool collect_cells(const cau_read_job *job, cells *out)
{
	const cau_session_info *info = &job->hosted->core.info;
	const tissue_copy *copy = job->copy;
	size_t most = (size_t)info->tetrahedron_count + (size_t)info->face_count + 1;
	out->vertex = malloc(most * 4 * sizeof *out->vertex);
	if (!out->vertex)
		return false;
	for (int32_t i = 0; i < info->tetrahedron_count; i++)
		if (copy->alive[i])
			memcpy(&out->vertex[4 * out->count++], &info->tetrahedron[4 * i], 4 * sizeof(int32_t));
	for (int32_t f = 0; f < info->face_count; f++) {
		if (!is_drawn(copy, f) || !is_sheet_face(info, f))
			continue;
		memcpy(&out->vertex[4 * out->count], &info->face[3 * f], 3 * sizeof(int32_t));
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

static void write_points(const cau_read_job *job, FILE *stream)
{
	const cau_session_info *info = &job->hosted->core.info;
	const tissue_copy *copy = job->copy;
	fputs("<Points>\n", stream);
	write_array(stream, "Float64", "position_m", 3);
	for (int32_t v = 0; v < info->vertex_count; v++)
		fprintf(stream, "%.9g %.9g %.9g\n", copy->position[3 * v], copy->position[3 * v + 1],
		        copy->position[3 * v + 2]);
	fputs("</DataArray>\n</Points>\n<PointData>\n", stream);
	write_array(stream, "Float32", "exposure", 1);
	for (int32_t v = 0; v < info->vertex_count; v++)
		fprintf(stream, "%.6g\n", (double)copy->exposure[v]);
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

static void write_vtu(const cau_read_job *job, const cells *list, FILE *stream)
{
	fprintf(stream,
	        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
	        "byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"%d\" "
	        "NumberOfCells=\"%d\">\n",
	        job->hosted->core.info.vertex_count, list->count);
	write_points(job, stream);
	write_cells(list, stream);
	fputs("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", stream);
}

static void make_tissue_file(cau_read_job *job)
{
	char *bytes = NULL;
	size_t count = 0;
	cells list = {0};
	bool vtu = job->order->as.format == CAU_EXPORT_VTU;
	FILE *stream = open_memstream(&bytes, &count);
	bool done = stream && (!vtu || collect_cells(job, &list));
	if (done && vtu)
		write_vtu(job, &list, stream);
	else if (done)
		write_obj(job, stream);
	if (stream)
		done = fclose(stream) == 0 && done;
	if (done)
		answer_file(job, bytes, count, vtu ? "vtu" : "obj", vtu ? "application/xml" : "model/obj");
	else
		fail(&job->order->reply, CAU_NO_MEMORY, "no memory for the file");
	free(list.vertex);
	free(bytes);
}

void cau_apply_export(cau_hosted *h, cau_order *order)
{
	tissue_copy *copy = copy_tissue(&h->core, h->reads.copies);
	if (!copy) {
		fail(&order->reply, CAU_NO_MEMORY, "no memory for the file");
		free(order);
		return;
	}
	double lines = (double)h->core.info.vertex_count + h->core.info.face_count +
	               h->core.info.tetrahedron_count;
	cau_reads_hand_over(h, order, make_tissue_file, copy, cau_shelf_give_back, LINE_S * lines);
}

// ---- the log
static cau_status write_line(void *user, const cau_store_command *row)
{
	char json[CAU_COMMAND_JSON_MAX_BYTES];
	size_t bytes = 0;
	cau_command command;
	cau_error error;
	if (row->kind == CAU_STORE_REACHED)
		return CAU_OK;
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

static void make_log_file(cau_read_job *job)
{
	char *bytes = NULL;
	size_t count = 0;
	cau_error error = {.reason = "no memory for the log"};
	cau_store *store = job->hosted->identity.around->store;
	uint64_t to = job->order->as.log.to_tick < job->tick ? job->order->as.log.to_tick : job->tick;
	FILE *stream = open_memstream(&bytes, &count);
	cau_store_flush(store);
	cau_status status = stream ? cau_store_read_log(store, job->hosted->identity.id, job->branch,
	                                                job->order->as.log.from_tick, to + 1,
	                                                write_line, stream, &error)
	                           : CAU_NO_MEMORY;
	if (stream && fclose(stream))
		status = CAU_NO_MEMORY;
	if (status)
		fail(&job->order->reply, status, error.reason);
	else
		answer_file(job, bytes, count, "jsonl", "application/jsonl");
	free(bytes);
}

void cau_apply_log(cau_hosted *h, cau_order *order)
{
	cau_reads_hand_over(h, order, make_log_file, NULL, NULL, LOG_EXPECTED_S);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/mesh_reading.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/mesh_scene.h"
#include "cautery/solid.h"
#include "hosted_session/internal.h"
#include "log/log.h"

// Estimates from which a job's time is computed. The builder sorts its jobs by this time.
#define READ_BYTES_PER_S 20e6 // speed of reading text, bytes/s
// Time that is added if the surface may be filled, s. With it, the job is too long for the thread
// for short jobs, and another thread takes it.
#define FILL_S 1.0

enum { MENDS_MAX = 16 };

typedef struct reading {
	cau_job job; // must be the first member
	cau_builder *builder;
	cau_mesh_asked asked;
	cau_reply reply;
	cau_scene_def scene;
	cau_mesh_report report;
	cau_wire_mesh_kind kind[CAU_MESH_KIND_MAX];
	cau_wire_mesh_mend mend[MENDS_MAX];
	cau_wire_mesh_region region[CAU_MESH_REGION_MAX];
	cau_wire_mesh_reading result;
	// report on the filling with tetrahedra; "": nothing was filled
	char filled[CAU_FILL_REPORT_BYTES];
} reading;

static void finish(reading *what, const cau_error *error, const cau_outcome *done)
{
	cau_filling_end(what->asked.filling);
	if (error)
		cau_reply_fail(&what->reply, error, 0);
	else
		cau_reply_answer(&what->reply, done);
	cau_filling_release(what->asked.filling);
	free(what->asked.bytes);
	free(what);
}

static void drop(cau_job *job)
{
	cau_error error = {.status = CAU_BAD_STATE, .reason = "the server is shutting down"};
	finish((reading *)job, &error, NULL);
}

static void fill_lists(reading *what, cau_wire_mesh_report *to)
{
	const cau_mesh_report *from = &what->report;
	to->kinds = (cau_wire_list){what->kind, from->kind_count, CAU_MESH_KIND_MAX};
	for (int32_t i = 0; i < from->kind_count; i++) {
		snprintf(what->kind[i].name, sizeof what->kind[i].name, "%s", from->kind[i].name);
		what->kind[i].read = from->kind[i].read;
		what->kind[i].passed = from->kind[i].passed;
	}
	to->mended = (cau_wire_list){what->mend, 0, MENDS_MAX};
#define X(field, strict, words)                                                                    \
	if (from->field) {                                                                             \
		cau_wire_mesh_mend *made = &what->mend[to->mended.count++];                                \
		snprintf(made->what, sizeof made->what, "%s", words);                                      \
		made->count = from->field;                                                                 \
	}
	CAU_MESH_MEND_TABLE(X)
#undef X
	int32_t regions =
		from->region_count < CAU_MESH_REGION_MAX ? from->region_count : CAU_MESH_REGION_MAX;
	to->regions = (cau_wire_list){what->region, regions, CAU_MESH_REGION_MAX};
	for (int32_t i = 0; i < regions; i++) {
		what->region[i].dimension = from->region[i].dimension;
		what->region[i].region = from->region[i].region;
		what->region[i].element_count = from->region[i].element_count;
		snprintf(what->region[i].name, sizeof what->region[i].name, "%s", from->region[i].name);
	}
}

static void fill(reading *what, cau_wire_mesh_report *to)
{
	const cau_mesh_report *from = &what->report;
	snprintf(to->format, sizeof to->format, "%s", from->format);
	to->vertices_read = from->vertices_read;
	to->vertex_count = from->vertex_count;
	to->triangle_count = from->triangle_count;
	to->tetrahedron_count = from->tetrahedron_count;
	to->component_count = from->component_count;
	to->open_edge_count = from->open_edge_count;
	to->region_count = from->region_count;
	memcpy(to->least_m, from->least_m, sizeof to->least_m);
	memcpy(to->most_m, from->most_m, sizeof to->most_m);
	to->unit_m = from->unit_m;
	for (int i = 0; i < CAU_MESH_QUALITY_BINS; i++)
		to->quality[i] = from->quality[i];
	to->least_quality = from->least_quality < 0   ? 0
	                    : from->least_quality > 1 ? 1
	                                              : from->least_quality;
	fill_lists(what, to);
}

// Writes the report as text: on the file, on the filling, and on the resulting mesh.
static void put_text(const reading *what, const cau_mesh_report *file, char *text, size_t bytes)
{
	char own[CAU_MESH_TEXT_BYTES], solid[CAU_MESH_TEXT_BYTES];
	own[0] = 0;
	if (file->format[0])
		cau_mesh_report_text(file, own);
	if (!what->filled[0]) {
		snprintf(text, bytes, "%s", own);
		return;
	}
	cau_mesh_report_text(&what->report, solid);
	const char *mesh = strstr(solid, "mesh: ");
	snprintf(text, bytes, "%s%s%s", own, what->filled, mesh ? mesh : solid);
}

// Adds a note for the user if the kind of the resulting tissue may be unexpected.
static void note(const reading *what, cau_wire_mesh_reading *result)
{
	const cau_mesh_report *report = &what->report;
	const char *words = NULL;
	if (what->asked.layer_kind < 0 && what->filled[0] && result->report.triangle_count)
		words = "the surface was filled with tetrahedra (as fat); it can be a sheet (as fascia)";
	else if (what->asked.layer_kind < 0 && !report->tetrahedron_count)
		words = "the surface became a sheet (as fascia), as its holes are too wide to fill it";
	result->has_note = words != NULL;
	snprintf(result->note, sizeof result->note, "%s", words ? words : "");
}

static bool is_over(void *user)
{
	return cau_builder_is_stopping(user);
}

static cau_status fill_upload(reading *what, double unit_m, cau_error *error)
{
	const cau_mesh_asked *asked = &what->asked;
	cau_fill_wish wish = {.bytes = asked->bytes,
	                      .byte_count = asked->byte_count,
	                      .file_name = asked->file_name,
	                      .edge = asked->edge_m / unit_m,
	                      .labels = asked->labels,
	                      .strict = asked->strict,
	                      .memory_mb = asked->memory_mb,
	                      .time_s = asked->time_s,
	                      .most_bytes = asked->most_bytes,
	                      .is_over = is_over,
	                      .user = what->builder};
	return cau_fill(asked->filling, &wish, what->filled, error);
}

// Reads the bytes as a mesh, and makes a scene with it.
static cau_status read_bytes(reading *what, const void *bytes, size_t byte_count, double unit_m,
                             cau_error *error)
{
	cau_mesh_wish wish = {.file = what->asked.file_name,
	                      .bytes = bytes,
	                      .byte_count = byte_count,
	                      .unit_m = unit_m,
	                      .layer_kind = what->asked.layer_kind,
	                      .strict = what->asked.strict,
	                      .pins = what->asked.pin};
	return cau_mesh_scene(&wish, &what->scene, &what->report, error);
}

static cau_status read_solid(reading *what, double unit_m, cau_error *error)
{
	const void *bytes;
	size_t byte_count;
	cau_status status = fill_upload(what, unit_m, error);
	int guessed = what->report.unit_guessed;
	if (status || !cau_filling_solid(what->asked.filling, &bytes, &byte_count))
		return status;
	status = read_bytes(what, bytes, byte_count, unit_m, error);
	what->report.unit_guessed = guessed;
	return status;
}

// Reads a surface unfilled first, for its report and its unit. Sets *has_inside if the surface is
// to be filled.
static cau_status read_surface(reading *what, bool *has_inside, cau_error *error)
{
	int32_t kind = what->asked.layer_kind;
	if (!what->asked.as_it_is && kind == CAU_LAYER_FAT)
		what->asked.layer_kind = -1;
	cau_status status =
		read_bytes(what, what->asked.bytes, what->asked.byte_count, what->asked.unit_m, error);
	what->asked.layer_kind = kind;
	const cau_mesh_report *report = &what->report;
	bool wanted = kind == CAU_LAYER_FAT || (kind < 0 && report->opening <= CAU_NEARLY_CLOSED);
	*has_inside = !status && !what->asked.as_it_is && wanted && !report->tetrahedron_count;
	return status;
}

static cau_status read_mesh(reading *what, cau_mesh_report *file, cau_error *error)
{
	const cau_mesh_asked *asked = &what->asked;
	bool volume = cau_solid_is_volume(asked->bytes, asked->byte_count), has_inside = volume;
	if (volume && asked->layer_kind == CAU_LAYER_FASCIA)
		return cau_fail(error, CAU_BAD_VALUE, "as",
		                "a segmentation cannot become a sheet: use it as a solid (as fat)");
	if (!volume && asked->labels[0])
		return cau_fail(error, CAU_BAD_VALUE, "labels",
		                "this file is not a segmentation, so it has no labels");
	cau_status status = volume ? CAU_OK : read_surface(what, &has_inside, error);
	*file = what->report;
	if (status || !has_inside)
		return status;
	return read_solid(what,
	                  !volume             ? file->unit_m
	                  : asked->unit_m > 0 ? asked->unit_m
	                                      : 1e-3,
	                  error);
}

// Puts the uploaded file's numbers into the report, in place of the numbers of the solid made from
// this file.
static void keep_of_file(reading *what, const cau_mesh_report *file)
{
	cau_mesh_report *to = &what->report;
	to->vertices_read = file->vertices_read;
	to->kind_count = file->kind_count;
	memcpy(to->kind, file->kind, sizeof to->kind);
#define X(field, strict, words) to->field = file->field;
	CAU_MESH_MEND_TABLE(X)
#undef X
	to->triangle_count = file->triangle_count;
	to->open_edge_count = file->open_edge_count;
	if (file->format[0])
		snprintf(to->format, sizeof to->format, "%s", file->format);
	else if (sscanf(what->filled, "format: %31[^,]", to->format) != 1)
		to->format[0] = 0;
}

static cau_status read_and_answer(reading *what, cau_outcome *done, cau_error *error)
{
	cau_wire_mesh_reading *result = &what->result;
	cau_mesh_report *file = calloc(1, sizeof *file);
	if (!file)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for a report");
	cau_status status = read_mesh(what, file, error);
	if (!status) {
		result->definition = &what->scene;
		snprintf(what->scene.meshes[0].file, sizeof what->scene.meshes[0].file, "%s",
		         what->asked.upload);
		put_text(what, file, result->report.text, sizeof result->report.text);
		if (what->filled[0])
			keep_of_file(what, file);
		fill(what, &result->report);
		note(what, result);
		done->text = cau_answer_text(what->reply.method, result, &done->text_bytes, error);
		status = done->text ? CAU_OK : error->status;
	}
	free(file);
	return status;
}

static void run(cau_job *job)
{
	reading *what = (reading *)job;
	cau_error error = {0};
	cau_outcome done = {0};
	cau_status status = read_and_answer(what, &done, &error);
	char *text = (char *)done.text;
	if (status) {
		char path[sizeof error.path];
		snprintf(path, sizeof path, "params%s%.140s", error.path[0] ? "." : ".upload", error.path);
		memcpy(error.path, path, sizeof path);
		cau_log(CAU_LOG_NOTICE, NULL, "mesh_refused", "file=\"%s\" reason=\"%s\"",
		        what->asked.file_name, error.reason);
	}
	finish(what, status ? &error : NULL, &done);
	free(text);
}

cau_status cau_mesh_ask(cau_builder *builder, const cau_mesh_asked *asked, const cau_reply *reply,
                        cau_error *error)
{
	reading *what = calloc(1, sizeof *what);
	if (!what) {
		cau_filling_release(asked->filling);
		free(asked->bytes);
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for reading a mesh");
	}
	double expected_s = (double)asked->byte_count / READ_BYTES_PER_S;
	what->job = (cau_job){
		.run = run, .drop = drop, .expected_s = expected_s + (asked->as_it_is ? 0 : FILL_S)};
	what->builder = builder;
	what->asked = *asked;
	what->reply = *reply;
	cau_builder_submit(builder, &what->job);
	return CAU_OK;
}

void cau_mesh_log(const char *session, const cau_scene_def *scene, const cau_mesh_report *report)
{
	char text[CAU_MESH_TEXT_BYTES];
	for (int32_t i = 0; report && i < scene->mesh_count; i++) {
		const cau_mesh_def *mesh = &scene->meshes[i];
		if (mesh->source != CAU_MESH_FILE && mesh->source != CAU_MESH_BYTES)
			continue;
		cau_mesh_report_text(&report[i], text);
		for (const char *line = text; *line;) {
			size_t length = strcspn(line, "\n");
			cau_log(CAU_LOG_INFO, session, "mesh_read", "mesh=%s report=\"%.*s\"", mesh->name,
			        (int)length, line);
			line += length + (line[length] == '\n');
		}
	}
}

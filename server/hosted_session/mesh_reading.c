// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/mesh_reading.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/mesh_scene.h"
#include "hosted_session/internal.h"
#include "log/log.h"

#define READ_BYTES_PER_S 20e6 // about, of text: for the builder's order

enum { MENDS_MAX = 16 };

typedef struct reading {
	cau_job job; // first
	cau_mesh_asked asked;
	cau_reply reply;
	cau_scene_def scene;
	cau_mesh_report report;
	cau_wire_mesh_kind kind[CAU_MESH_KIND_MAX];
	cau_wire_mesh_mend mend[MENDS_MAX];
	cau_wire_mesh_region region[CAU_MESH_REGION_MAX];
} reading;

static void finish(reading *what, const cau_error *error, const cau_outcome *done)
{
	if (error)
		cau_reply_fail(&what->reply, error, 0);
	else
		cau_reply_answer(&what->reply, done);
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
	cau_mesh_report_text(from, to->text);
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

// What the user may not expect of the scene.
static void note(const reading *what, cau_wire_mesh_reading *result)
{
	const cau_mesh_report *report = &what->report;
	result->has_note = !report->tetrahedron_count && what->asked.layer_kind < 0;
	if (result->has_note)
		snprintf(
			result->note, sizeof result->note,
			"%s (as fascia); for a solid, fill the surface with tetrahedra first, as TetGen and "
			"gmsh -3 do",
			report->open_edge_count ? "the surface became a sheet"
									: "the closed surface became a hollow sheet");
}

static cau_status read_mesh(reading *what, cau_outcome *done, cau_error *error)
{
	cau_mesh_wish wish = {.file = what->asked.file_name,
	                      .bytes = what->asked.bytes,
	                      .byte_count = what->asked.byte_count,
	                      .unit_m = what->asked.unit_m,
	                      .layer_kind = what->asked.layer_kind,
	                      .strict = what->asked.strict};
	cau_wire_mesh_reading result = {.definition = &what->scene};
	cau_status status = cau_mesh_scene(&wish, &what->scene, &what->report, error);
	if (status)
		return status;
	snprintf(what->scene.meshes[0].file, sizeof what->scene.meshes[0].file, "%s",
	         what->asked.upload);
	fill(what, &result.report);
	note(what, &result);
	done->text = cau_answer_text(what->reply.method, &result, &done->text_bytes, error);
	return done->text ? CAU_OK : error->status;
}

static void run(cau_job *job)
{
	reading *what = (reading *)job;
	cau_error error = {0};
	cau_outcome done = {0};
	cau_status status = read_mesh(what, &done, &error);
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
		free(asked->bytes);
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for reading a mesh");
	}
	what->job = (cau_job){
		.run = run, .drop = drop, .expected_s = (double)asked->byte_count / READ_BYTES_PER_S};
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

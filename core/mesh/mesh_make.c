// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a clean mesh in metres from its definition.
#include <math.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"

// Joins `directory` and `file`. If `file` is absolute, `directory` is ignored.
static cau_status join_path(const char *directory, const char *file, char path[static 600],
                            cau_error *error)
{
	bool alone = file[0] == '/' || !directory || !directory[0];
	int length = snprintf(path, 600, "%s%s%s", alone ? "" : directory, alone ? "" : "/", file);
	if (length >= 600)
		return cau_fail(error, CAU_BAD_VALUE, "file", "the path is longer than 599 bytes");
	return CAU_OK;
}

static cau_status read_file(const cau_mesh_def *def, const char *directory, cau_mesh *mesh,
                            cau_mesh_report *report, cau_error *error)
{
	CAU_ASSERT(def->source == CAU_MESH_FILE, "a mesh of source %d is read from a file",
	           def->source);
	char path[600];
	void *bytes = NULL;
	size_t byte_count = 0;
	cau_status status = join_path(directory, def->file, path, error);
	if (!status)
		status = cau_mesh_file_load(path, &bytes, &byte_count, error);
	if (!status)
		status = cau_mesh_read(def->file, bytes, byte_count, mesh, report, error);
	free(bytes);
	return status;
}

static cau_status make_raw(const cau_mesh_def *def, const char *directory, cau_mesh *mesh,
                           cau_mesh_report *report, cau_error *error)
{
	switch (def->source) {
	case CAU_MESH_SHEET:
		return cau_mesh_make_sheet(def, mesh, error);
	case CAU_MESH_SLAB:
		return cau_mesh_make_slab(def, mesh, error);
	case CAU_MESH_PATTERN:
		return cau_mesh_make_pattern(def, mesh, error);
	case CAU_MESH_FILE:
		return read_file(def, directory, mesh, report, error);
	case CAU_MESH_BYTES:
		return cau_mesh_read(def->file, def->bytes, def->byte_count, mesh, report, error);
	default:
		return cau_fail(error, CAU_BAD_VALUE, "source", "no kind of mesh source has this number");
	}
}

static bool is_read(const cau_mesh_def *def)
{
	return def->source == CAU_MESH_FILE || def->source == CAU_MESH_BYTES;
}

static cau_status check_place(const cau_mesh_def *def, cau_error *error)
{
	if (is_read(def) && (!(def->unit_m > 0) || !isfinite(def->unit_m)))
		return cau_fail(error, CAU_BAD_VALUE, "unit_m", "must be above zero");
	for (int c = 0; c < 3; c++)
		if (!isfinite(def->translate_m[c]))
			return cau_fail(error, CAU_BAD_VALUE, "translate_m", "must be finite");
	return CAU_OK;
}

// Scales a mesh that was read to metres. Then moves the mesh.
static void place(const cau_mesh_def *def, cau_mesh *mesh)
{
	double unit_m = is_read(def) ? def->unit_m : 1;
	CAU_ASSERT(unit_m > 0, "a unit of %g m", unit_m);
	for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
		mesh->position[i] = unit_m * mesh->position[i] + def->translate_m[i % 3];
}

// Fails if the mesh has a size that no tissue has, or if a strict reading finds repairs.
static cau_status judge(const cau_mesh_def *def, const cau_mesh_report *report, cau_error *error)
{
	if (!is_read(def))
		return CAU_OK;
	double longest_m = 0;
	for (int c = 0; c < 3; c++)
		longest_m = fmax(longest_m, report->most_m[c] - report->least_m[c]);
	if (report->proposed_unit_m > 0)
		return cau_fail(error, CAU_BAD_MESH, "unit_m",
		                "this mesh is %.3g m long, which is not a plausible size of tissue: did "
		                "you mean %s (unit_m %g)?",
		                longest_m, cau_unit_name(report->proposed_unit_m), report->proposed_unit_m);
	return def->strict ? cau_mesh_report_refuse(report, error) : CAU_OK;
}

cau_status cau_mesh_make(const cau_mesh_def *def, const char *directory, cau_mesh *mesh,
                         cau_mesh_report *report, cau_error *error)
{
	cau_mesh_report unwanted;
	report = report ? report : &unwanted;
	*mesh = (cau_mesh){0};
	*report = (cau_mesh_report){0};
	cau_status status = check_place(def, error);
	if (status)
		return status;
	status = make_raw(def, directory, mesh, report, error);
	if (!status) {
		place(def, mesh);
		status = cau_mesh_clean(mesh, report, error);
	}
	if (!status)
		status = cau_mesh_report_measure(mesh, is_read(def) ? def->unit_m : 1, report, error);
	if (!status)
		status = judge(def, report, error);
	if (status) {
		cau_mesh_finish(mesh);
		if (error && is_read(def))
			snprintf(error->file, sizeof error->file, "%s", def->file);
	}
	return status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the report of a mesh as text, one fact on each line.
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "mesh/mesh.h"

typedef struct text {
	char *at;
	size_t left; // free bytes, with the terminating zero
} text;

__attribute__((format(printf, 2, 3))) static void put(text *out, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	int length = vsnprintf(out->at, out->left, format, arguments);
	va_end(arguments);
	size_t used = length < 0 ? 0 : (size_t)length < out->left ? (size_t)length : out->left - 1;
	out->at += used;
	out->left -= used;
}

// Writes a list of kinds, as in "read: 192 tetrahedra, 1 hexahedra" or "passed over: ...".
static void put_kinds(const cau_mesh_report *report, bool passed, const char *title, text *out)
{
	const char *before = title;
	for (int32_t i = 0; i < report->kind_count; i++) {
		const cau_mesh_kind *kind = &report->kind[i];
		int64_t count = passed ? kind->passed : kind->read;
		if (!count)
			continue;
		put(out, "%s%lld %s", before, (long long)count, kind->name);
		before = ", ";
	}
	if (before != title)
		put(out, "\n");
}

static void put_mended(const cau_mesh_report *report, text *out)
{
	const char *before = "mended: ";
#define X(field, strict, words)                                                                    \
	if (report->field) {                                                                           \
		put(out, "%s%d %s", before, report->field, words);                                         \
		before = ", ";                                                                             \
	}
	CAU_MESH_MEND_TABLE(X)
#undef X
	if (strcmp(before, ", ") == 0)
		put(out, "\n");
}

static void put_mesh(const cau_mesh_report *report, text *out)
{
	put(out, "mesh: %d vertices", report->vertex_count);
	if (report->tetrahedron_count)
		put(out, ", %d tetrahedra", report->tetrahedron_count);
	if (report->triangle_count)
		put(out, ", %d triangles", report->triangle_count);
	put(out, ", %d %s", report->component_count,
	    report->component_count == 1 ? "component" : "components");
	if (!report->tetrahedron_count && report->open_edge_count)
		put(out, ", open surface with %d edges on its rim", report->open_edge_count);
	else if (!report->tetrahedron_count)
		put(out, ", closed surface");
	put(out, "\n");
}

static void put_size(const cau_mesh_report *report, text *out)
{
	const double *a = report->least_m, *b = report->most_m;
	put(out, "size: %.4g x %.4g x %.4g m, unit_m %g (%s%s)\n", b[0] - a[0], b[1] - a[1],
	    b[2] - a[2], report->unit_m, cau_unit_name(report->unit_m),
	    report->unit_guessed ? ", guessed" : "");
}

static void put_regions(const cau_mesh_report *report, text *out)
{
	int32_t listed =
		report->region_count < CAU_MESH_REGION_MAX ? report->region_count : CAU_MESH_REGION_MAX;
	for (int32_t i = 0; i < listed; i++) {
		const cau_mesh_region *r = &report->region[i];
		put(out, "%s%d%s%s%s (%d %s)", i ? ", " : "regions: ", r->region, r->name[0] ? " \"" : "",
		    r->name, r->name[0] ? "\"" : "", r->element_count,
		    r->dimension == 3 ? "tetrahedra" : "triangles");
	}
	if (report->region_count > listed)
		put(out, " and %d more", report->region_count - listed);
	if (listed)
		put(out, "\n");
}

void cau_mesh_report_text(const cau_mesh_report *report, char bytes[CAU_MESH_TEXT_BYTES])
{
	text out = {bytes, CAU_MESH_TEXT_BYTES};
	bytes[0] = 0;
	put(&out, "format: %s, %lld vertices\n", report->format, (long long)report->vertices_read);
	put_kinds(report, false, "read: ", &out);
	put_kinds(report, true, "passed over: ", &out);
	put_mended(report, &out);
	put_mesh(report, &out);
	put_size(report, &out);
	put_regions(report, &out);
	put(&out, "quality in tenths from 0 to 1:");
	for (int i = 0; i < CAU_MESH_QUALITY_BINS; i++)
		put(&out, " %d", report->quality[i]);
	put(&out, ", least %.2g\n", report->least_quality);
}

// Whether elements of this kind are tissue. A strict reading may skip only other kinds.
static bool is_tissue(const char *kind)
{
	return !strstr(kind, "points") && !strstr(kind, "lines") && !strstr(kind, "vertices") &&
	       !strstr(kind, "edges");
}

cau_status cau_mesh_report_refuse(const cau_mesh_report *report, cau_error *error)
{
	char found[240] = "";
	text out = {found, sizeof found};
	const char *before = "";
#define X(field, strict, words)                                                                    \
	if (strict && report->field) {                                                                 \
		put(&out, "%s%d %s", before, report->field, words);                                        \
		before = ", ";                                                                             \
	}
	CAU_MESH_MEND_TABLE(X)
#undef X
	for (int32_t i = 0; i < report->kind_count; i++)
		if (report->kind[i].passed && is_tissue(report->kind[i].name)) {
			put(&out, "%s%lld %s passed over", before, (long long)report->kind[i].passed,
			    report->kind[i].name);
			before = ", ";
		}
	return found[0] ? cau_fail(error, CAU_BAD_MESH, "strict",
	                           "strict refuses to repair this mesh: %s", found)
	                : CAU_OK;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a mesh and its report from the bytes of a file. The format is found from the bytes.
#include <string.h>

#include "cautery/assert.h"
#include "mesh/cell_split.h"
#include "mesh/mesh_format.h"
#include "mesh/mesh_memory.h"
#include "mesh/report.h"

// Copies the mesh into arrays without spare capacity. Readers grow their arrays in larger steps.
static cau_status copy_tight(const cau_mesh *from, cau_mesh *mesh, cau_error *error)
{
	CAU_ASSERT(from->vertex_count >= 0 && from->triangle_count >= 0 && from->tetrahedron_count >= 0,
	           "%d vertices, %d triangles, %d tetrahedra", from->vertex_count, from->triangle_count,
	           from->tetrahedron_count);
	cau_status status = cau_mesh_reserve(mesh, from->vertex_count, from->triangle_count,
	                                     from->tetrahedron_count, from->texture != NULL, error);
	if (status)
		return status;
	size_t triangles = (size_t)from->triangle_count, tetrahedra = (size_t)from->tetrahedron_count;
	memcpy(mesh->position, from->position, 3 * (size_t)from->vertex_count * sizeof(double));
	if (triangles) {
		memcpy(mesh->triangle, from->triangle, 3 * triangles * sizeof(int32_t));
		memcpy(mesh->triangle_region, from->triangle_region, triangles * sizeof(int32_t));
	}
	if (triangles && from->texture)
		memcpy(mesh->texture, from->texture, 6 * triangles * sizeof(double));
	if (tetrahedra) {
		memcpy(mesh->tetrahedron, from->tetrahedron, 4 * tetrahedra * sizeof(int32_t));
		memcpy(mesh->tetrahedron_region, from->tetrahedron_region, tetrahedra * sizeof(int32_t));
	}
	return CAU_OK;
}

static cau_status refuse_format(const char *name, const cau_mesh_format *format, cau_error *error)
{
	if (format)
		return cau_fail(error, CAU_UNSUPPORTED, NULL, "'%.80s' is %s", name, format->refusal);
	return cau_fail(error, CAU_UNSUPPORTED, NULL,
	                "'%.80s' has none of the supported formats: Gmsh, VTK, VTU, OBJ, STL, PLY, "
	                "Medit, TetGen, USD (.usda), and segmentations in NRRD or NIfTI",
	                name);
}

// Replaces carriage returns by line feeds in a text that has no line feeds. Returns a copy that the
// caller frees. Returns NULL if no copy is needed, or if memory ran out. In the latter case the
// text has one line only and is refused.
static unsigned char *with_line_feeds(const unsigned char *bytes, size_t byte_count)
{
	if (memchr(bytes, '\n', byte_count) || !memchr(bytes, '\r', byte_count))
		return NULL;
	unsigned char *copy = malloc(byte_count);
	for (size_t i = 0; copy && i < byte_count; i++)
		copy[i] = bytes[i] == '\r' ? '\n' : bytes[i];
	return copy;
}

// Splits the cells. If there are neither triangles nor tetrahedra, fails with a list of what the
// file contains instead.
static cau_status end_reading(cau_mesh_builder *builder)
{
	cau_mesh_report *report = &builder->report;
	report->vertices_read = builder->mesh.vertex_count;
	cau_cell_split(builder);
	if (builder->scan->status || builder->mesh.triangle_count || builder->mesh.tetrahedron_count)
		return builder->scan->status;
	char found[160];
	size_t length =
		(size_t)snprintf(found, sizeof found, "%d vertices", builder->mesh.vertex_count);
	for (int32_t i = 0; i < report->kind_count && length < sizeof found; i++) {
		long long count = report->kind[i].passed;
		count += report->kind[i].read;
		if (count)
			length += (size_t)snprintf(found + length, sizeof found - length, ", %lld %s", count,
			                           report->kind[i].name);
	}
	cau_scan_fail(builder->scan, CAU_BAD_MESH,
	              "no surface and no volume elements in this file, but %s", found);
	return builder->scan->status;
}

static cau_status read_as(const cau_mesh_format *format, const unsigned char *bytes,
                          size_t byte_count, cau_mesh *mesh, cau_mesh_report *report,
                          cau_error *error)
{
	unsigned char *copy = format->text ? with_line_feeds(bytes, byte_count) : NULL;
	cau_scan scan = cau_scan_make(copy ? copy : bytes, byte_count, error);
	cau_mesh_builder builder = {.scan = &scan};
	snprintf(builder.report.format, sizeof builder.report.format, "%s", format->name);
	cau_status status = format->read(&builder);
	if (!status)
		status = end_reading(&builder);
	if (!status)
		status = copy_tight(&builder.mesh, mesh, error);
	if (!status)
		cau_mesh_report_regions(&builder, &builder.report);
	if (report)
		*report = builder.report;
	cau_mesh_builder_finish(&builder);
	free(copy);
	return status;
}

cau_status cau_mesh_read(const char *name, const void *bytes, size_t byte_count, cau_mesh *mesh,
                         cau_mesh_report *report, cau_error *error)
{
	CAU_ASSERT(bytes || !byte_count, "%zu bytes that are nowhere", byte_count);
	static const unsigned char byte_order_mark[] = {0xef, 0xbb, 0xbf};
	const unsigned char *from = bytes;
	*mesh = (cau_mesh){0};
	if (byte_count >= sizeof byte_order_mark &&
	    !memcmp(from, byte_order_mark, sizeof byte_order_mark)) {
		from += sizeof byte_order_mark;
		byte_count -= sizeof byte_order_mark;
	}
	if (!byte_count)
		return cau_fail(error, CAU_BAD_SYNTAX, NULL, "'%.80s' is empty", name);
	const cau_mesh_format *format = cau_mesh_format_of(from, byte_count);
	if (!format || !format->read)
		return refuse_format(name, format, error);
	return read_as(format, from, byte_count, mesh, report, error);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target for mesh files; the format is detected from the bytes. A mesh that was read and
// cleaned must have the properties that later code relies on.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz_target.h"
#include "mesh/edge_table.h"
#include "mesh/mesh.h"

static void demand(int promise)
{
	if (!promise)
		abort();
}

static double volume6(const double *position, const int32_t *t)
{
	double e[3][3];
	for (int i = 0; i < 3; i++)
		for (int c = 0; c < 3; c++)
			e[i][c] = position[3 * t[i + 1] + c] - position[3 * t[0] + c];
	return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
	       e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
	       e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static void check_read(const cau_mesh *mesh)
{
	demand(mesh->triangle_count > 0 || mesh->tetrahedron_count > 0);
	for (int32_t i = 0; i < 3 * mesh->vertex_count; i++)
		demand(isfinite(mesh->position[i]));
	for (int32_t i = 0; i < 3 * mesh->triangle_count; i++)
		demand(mesh->triangle[i] >= 0 && mesh->triangle[i] < mesh->vertex_count);
	for (int32_t i = 0; i < 4 * mesh->tetrahedron_count; i++)
		demand(mesh->tetrahedron[i] >= 0 && mesh->tetrahedron[i] < mesh->vertex_count);
}

static void check_tables(const cau_mesh *mesh)
{
	cau_primitives primitives = {.vertex_count = mesh->vertex_count,
	                             .triangle_count = mesh->triangle_count,
	                             .triangle = mesh->triangle,
	                             .tetrahedron_count = mesh->tetrahedron_count,
	                             .tetrahedron = mesh->tetrahedron};
	cau_edge_table edges;
	cau_face_table faces;
	cau_error error = {0};
	// Uses regions as layers, because any numbers will do.
	demand(!cau_edge_table_make(&primitives, mesh->triangle_region, &edges, &error));
	for (int32_t t = 0; t < mesh->triangle_count; t++)
		demand(cau_edge_table_find(&edges, mesh->triangle[3 * t], mesh->triangle[3 * t + 1]) ==
		       edges.triangle_edge[3 * t]);
	cau_edge_table_finish(&edges);
	cau_status status = cau_face_table_make(&primitives, &faces, &error);
	demand(status == CAU_OK || (status == CAU_BAD_MESH && error.reason[0]));
	cau_face_table_finish(&faces);
}

// Checks that the report counts every element.
static void check_report(const cau_mesh *mesh, const cau_mesh_report *report)
{
	char text[CAU_MESH_TEXT_BYTES];
	int64_t counted = 0, elements = mesh->triangle_count + (int64_t)mesh->tetrahedron_count;
	for (int32_t i = 0; i < report->region_count && i < CAU_MESH_REGION_MAX; i++)
		counted += report->region[i].element_count;
	demand(report->region_count > CAU_MESH_REGION_MAX ? counted <= elements : counted == elements);
	demand(report->component_count >= 1);
	cau_mesh_report_text(report, text);
	demand(strlen(text) < sizeof text);
}

static void check_clean(cau_mesh *mesh, cau_mesh_report *report)
{
	cau_mesh_report again = {0};
	cau_error error = {0};
	if (cau_mesh_clean(mesh, report, &error)) {
		demand(error.reason[0] != 0);
		return;
	}
	check_read(mesh);
	for (int32_t t = 0; t < mesh->tetrahedron_count; t++)
		demand(volume6(mesh->position, mesh->tetrahedron + 4 * t) > 0);
	check_tables(mesh);
	demand(!cau_mesh_clean(mesh, &again, &error));
	demand(again.unused_vertices == 0 && again.inverted_tetrahedra == 0);
	demand(!cau_mesh_report_measure(mesh, 1, report, &error));
	check_report(mesh, report);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	cau_mesh mesh;
	cau_mesh_report report;
	cau_error error = {0};
	cau_status status = cau_mesh_read("fuzz", data, bytes, &mesh, &report, &error);
	if (status) {
		demand(error.status == status && error.reason[0] != 0 && !mesh.position);
		return 0;
	}
	check_read(&mesh);
	check_clean(&mesh, &report);
	cau_mesh_finish(&mesh);
	return 0;
}

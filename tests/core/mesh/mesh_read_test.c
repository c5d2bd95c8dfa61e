// SPDX-License-Identifier: GPL-3.0-or-later
// Reads meshes from other programs. The variable CAUTERY_MESHES names their folder. Without this
// folder the test prints a message and is skipped.
#include "mesh_fixture.h"

#include <stdio.h>
#include <sys/stat.h>

static const char *directory;

static const struct {
	const char *file;
	int32_t vertex_count, triangle_count, tetrahedron_count, duplicate_vertices;
	int has_texture;
	double unit_m;
} meshes[] = {
	{"liver.msh", 181, 0, 596, 0, 0, 0.01},
	{"liver_low_volume.msh", 863, 0, 2839, 0, 0, 0.01},
	{"msh4_cube.msh", 14, 24, 24, 0, 0, 0.01},
	{"liver-smoothUV.obj", 2194, 4384, 0, 0, 1, 0.01},
	{"Cautery-Hook.obj", 747, 1208, 0, 170, 1, 0.001},
};

static void check_tables(const cau_mesh *mesh)
{
	cau_primitives primitives = fixture_primitives(mesh);
	int32_t *layer = calloc((size_t)mesh->triangle_count + 1, sizeof *layer);
	cau_edge_table edges;
	cau_face_table faces;
	assert_int_equal(cau_edge_table_make(&primitives, layer, &edges, NULL), CAU_OK);
	assert_int_equal(cau_face_table_make(&primitives, &faces, NULL), CAU_OK);
	assert_int_equal(edges.first[CAU_PRIMITIVE_TRIANGLE][edges.edge_count],
	                 3 * mesh->triangle_count);
	assert_int_equal(edges.first[CAU_PRIMITIVE_TETRAHEDRON][edges.edge_count],
	                 6 * mesh->tetrahedron_count);
	cau_face_table_finish(&faces);
	cau_edge_table_finish(&edges);
	free(layer);
}

static void real_meshes_load(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++) {
		cau_mesh_def def = fixture_def(1, 1, 1);
		def.source = CAU_MESH_FILE;
		def.unit_m = meshes[i].unit_m;
		snprintf(def.file, sizeof def.file, "%s", meshes[i].file);
		cau_mesh mesh;
		cau_mesh_report report;
		cau_error error = {0};
		if (cau_mesh_make(&def, directory, &mesh, &report, &error))
			fail_msg("%s: %s", error.file, error.reason);
		assert_int_equal(mesh.vertex_count, meshes[i].vertex_count);
		assert_int_equal(mesh.triangle_count, meshes[i].triangle_count);
		assert_int_equal(mesh.tetrahedron_count, meshes[i].tetrahedron_count);
		assert_int_equal(report.duplicate_vertices, meshes[i].duplicate_vertices);
		assert_int_equal(mesh.texture != NULL, meshes[i].has_texture);
		check_tables(&mesh);
		cau_mesh_finish(&mesh);
	}
}

int main(void)
{
	directory = getenv("CAUTERY_MESHES");
	struct stat about;
	if (!directory || stat(directory, &about)) {
		printf("skipped: CAUTERY_MESHES names no folder of meshes\n");
		return 77;
	}
	const struct CMUnitTest tests[] = {cmocka_unit_test(real_meshes_load)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

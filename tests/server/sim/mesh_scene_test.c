// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the scene that is made around a block of hexahedra, 120 x 120 x 30 units.
#include "sim/scene.h"

#include <math.h>

#include "cautery/scene_json.h"
#include "sim_fixture.h"

enum { N = 9 }; // vertices on a horizontal side

static const char *write_block(const char *name)
{
	const char *path = fixture_path(name);
	FILE *out = fopen(path, "w");
	assert_non_null(out);
	fprintf(out, "MeshVersionFormatted 2\nDimension 3\nVertices %d\n", 3 * N * N);
	for (int i = 0; i < 3 * N * N; i++)
		fprintf(out, "%d %d %d 0\n", 15 * (i % N), 15 * (i / N % N), 15 * (i / N / N));
	fprintf(out, "Hexahedra %d\n", 2 * (N - 1) * (N - 1));
	for (int c = 0; c < 2 * (N - 1) * (N - 1); c++) {
		int v = 1 + c % (N - 1) + c / (N - 1) % (N - 1) * N + c / (N - 1) / (N - 1) * N * N;
		fprintf(out, "%d %d %d %d %d %d %d %d 1\n", v, v + 1, v + 1 + N, v + N, v + N * N,
		        v + 1 + N * N, v + 1 + N + N * N, v + N + N * N);
	}
	fprintf(out, "End\n");
	assert_int_equal(fclose(out), 0);
	return path;
}

static cau_mesh_wish wish_of(const char *file, double unit_m)
{
	return (cau_mesh_wish){.file = file, .unit_m = unit_m, .layer_kind = -1};
}

static void a_scene_is_made_around_the_mesh(void **state)
{
	(void)state;
	static char text[CAU_SCENE_JSON_MAX_BYTES];
	size_t bytes;
	cau_error error = {0};
	cau_scene_def *scene = malloc(sizeof *scene), *again = malloc(sizeof *again);
	const char *file = write_block("My Liver_2.final.msh");
	cau_mesh_wish wish = wish_of(file, 0.001);
	assert_int_equal(sim_mesh_scene(&wish, scene, &error), CAU_OK);
	assert_string_equal(scene->name, "my-liver-2");
	assert_string_equal(scene->meshes[0].file, file);
	assert_true(scene->meshes[0].unit_m == 0.001);
	assert_int_equal(scene->parting, CAU_PARTING_ELEMENTS);
	assert_int_equal(scene->layer_count, 2);
	assert_int_equal(scene->layers[0].kind, CAU_LAYER_FAT);
	assert_string_equal(scene->layers[1].of, "fat");
	// The cut is over 60 % of the extent, at the surface.
	assert_true(fabs(scene->cut.to_m[0] - scene->cut.from_m[0] - 0.072) < 1e-12);
	assert_true(fabs(scene->cut.from_m[2] - 0.03) < 1e-12 &&
	            fabs(scene->cut.to_m[2] - 0.03) < 1e-12);
	assert_string_equal(scene->cut.tool, scene->tools[0].name);
	assert_true(scene->tools[0].pose.position_m[2] > 0.03);
	assert_true(scene->gravity_m_s2[2] == 0.0);
	// The block's edges are 15 mm long, its diagonals longer.
	double radius_m = scene->tools[0].hot_radius_m;
	assert_true(radius_m > 0.015 && radius_m < 0.015 * sqrt(3.0));
	assert_true(fabs(scene->cut.speed_m_s - radius_m / 1.5) < 1e-12);
	// The made scene can be written and read like any other scene.
	assert_int_equal(cau_scene_to_json(scene, text, sizeof text, &bytes, &error), CAU_OK);
	assert_int_equal(cau_scene_from_json("made", text, bytes, again, &error), CAU_OK);
	assert_memory_equal(scene, again, sizeof *scene);
	free(again);
	free(scene);
}

static void names_are_made_valid(void **state)
{
	(void)state;
	static const struct {
		const char *file, *name;
	} pairs[] = {{"liver.msh", "liver"},
	             {"09-x.obj", "x"},
	             {"__.vtk", "mesh"},
	             {"Ab--Cd_.vtk", "ab-cd"},
	             {"7.msh", "mesh"}};
	cau_scene_def *scene = malloc(sizeof *scene);
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		cau_mesh_wish wish = wish_of(write_block(pairs[i].file), 0.001);
		assert_int_equal(sim_mesh_scene(&wish, scene, NULL), CAU_OK);
		assert_string_equal(scene->name, pairs[i].name);
	}
	free(scene);
}

static void long_file_names_are_refused(void **state)
{
	(void)state;
	char file[400];
	cau_error error = {0};
	cau_scene_def *scene = malloc(sizeof *scene);
	memset(file, 'a', sizeof file);
	snprintf(file + 300, 10, ".msh");
	cau_mesh_wish wish = wish_of(file, 1.0);
	assert_int_equal(sim_mesh_scene(&wish, scene, &error), CAU_LIMIT);
	free(scene);
}

static void refusals_name_the_options(void **state)
{
	(void)state;
	cau_error error = {0};
	cau_scene_def *scene = malloc(sizeof *scene);
	cau_mesh_wish wish = wish_of(write_block("large.mesh"), 1); // the block is 120 m long
	assert_int_equal(sim_mesh_scene(&wish, scene, &error), CAU_BAD_MESH);
	assert_non_null(strstr(error.reason, "did you mean millimetres (--unit-m 0.001)?"));
	assert_string_equal(error.path, "");
	wish.unit_m = 0.001;
	wish.strict = 1;
	assert_int_equal(sim_mesh_scene(&wish, scene, &error), CAU_BAD_MESH);
	assert_non_null(strstr(error.reason, "--strict refuses to repair this mesh: 128 hexahedra"));
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_scene_is_made_around_the_mesh),
		cmocka_unit_test(names_are_made_valid),
		cmocka_unit_test(long_file_names_are_refused),
		cmocka_unit_test(refusals_name_the_options),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

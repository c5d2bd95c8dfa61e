// SPDX-License-Identifier: GPL-3.0-or-later
// Against the double, whose mesh is always a flat sheet of 0.12 x 0.12 m at z = 0.
#include "sim/mesh_scene.h"

#include <math.h>

#include "cautery/scene_json.h"
#include "sim_fixture.h"

static void a_scene_is_made_around_the_mesh(void **state)
{
	(void)state;
	static char text[CAU_SCENE_JSON_MAX_BYTES];
	size_t bytes;
	cau_error error = {0};
	cau_scene_def *scene = malloc(sizeof *scene), *again = malloc(sizeof *again);
	assert_int_equal(sim_mesh_scene("some/My Liver_2.final.msh", 0.001, scene, &error), CAU_OK);
	assert_string_equal(scene->name, "my-liver-2");
	assert_string_equal(scene->meshes[0].file, "some/My Liver_2.final.msh");
	assert_true(scene->meshes[0].unit_m == 0.001);
	assert_int_equal(scene->parting, CAU_PARTING_ELEMENTS);
	assert_int_equal(scene->layer_count, 2);
	assert_int_equal(scene->layers[0].kind, CAU_LAYER_FAT);
	assert_string_equal(scene->layers[1].of, "fat");
	// 60 % of the extent, at the surface.
	assert_true(fabs(scene->cut.to_m[0] - scene->cut.from_m[0] - 0.072) < 1e-12);
	assert_true(scene->cut.from_m[2] == 0.0 && scene->cut.to_m[2] == 0.0);
	assert_string_equal(scene->cut.tool, scene->tools[0].name);
	assert_true(scene->tools[0].pose.position_m[2] > 0.0);
	assert_true(scene->gravity_m_s2[2] == 0.0);
	// Its edges are 7.5 mm and sqrt(2) times that; one in three is a diagonal.
	assert_true(fabs(scene->tools[0].hot_radius_m - 0.0075 * (2.0 + sqrt(2.0)) / 3.0) < 1e-12);
	assert_true(fabs(scene->cut.speed_m_s - scene->tools[0].hot_radius_m / 1.5) < 1e-12);
	// It is a scene like any other.
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
	             {"a/b/09-x.obj", "x"},
	             {"__.vtk", "mesh"},
	             {"Ab--Cd_.vtk", "ab-cd"},
	             {"7.msh", "mesh"}};
	cau_scene_def *scene = malloc(sizeof *scene);
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		assert_int_equal(sim_mesh_scene(pairs[i].file, 1.0, scene, NULL), CAU_OK);
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
	assert_int_equal(sim_mesh_scene(file, 1.0, scene, &error), CAU_LIMIT);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_scene_is_made_around_the_mesh),
		cmocka_unit_test(names_are_made_valid),
		cmocka_unit_test(long_file_names_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

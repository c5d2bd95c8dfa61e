// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene.h"

#include "sim_fixture.h"

static void scenes_are_found_by_name_and_by_file(void **state)
{
	(void)state;
	cau_scene_def *scene = malloc(sizeof *scene);
	cau_error error = {0};
	assert_int_equal(sim_scene_load("layers", CAU_TEST_SCENES, 1.0, false, scene, &error), CAU_OK);
	assert_string_equal(scene->name, "layers");
	assert_string_equal(scene->directory, CAU_TEST_SCENES);
	fixture_write(fixture_path("mine.json"), "{\"name\":\"own\"}");
	assert_int_equal(sim_scene_load(fixture_path("mine.json"), NULL, 1.0, false, scene, &error),
	                 CAU_OK);
	assert_string_equal(scene->name, "own");
	assert_string_equal(scene->directory, fixture_folder());
	free(scene);
}

static void expect_failure(const char *source, cau_status status, const char *file,
                           const char *reason)
{
	cau_scene_def *scene = malloc(sizeof *scene);
	cau_error error = {0};
	assert_int_equal(sim_scene_load(source, CAU_TEST_SCENES, 1.0, false, scene, &error), status);
	assert_string_equal(error.file, file);
	if (!strstr(error.reason, reason))
		fail_msg("%s: \"%s\" does not say \"%s\"", source, error.reason, reason);
	free(scene);
}

static void what_cannot_be_read_is_named(void **state)
{
	(void)state;
	const char *bad = fixture_path("bad.json");
	fixture_write(bad, "{\"name\":\"own\",\"step_s\":9}");
	expect_failure(bad, CAU_BAD_VALUE, bad, "9 is outside");
	expect_failure("not-there", CAU_NOT_FOUND, "", "not-there");
	expect_failure("../layers", CAU_BAD_VALUE, "", "is neither the name of a scene");
	expect_failure("", CAU_BAD_VALUE, "", "is neither the name of a scene");
	expect_failure("/nowhere/x.json", CAU_IO, "/nowhere/x.json", "cannot open");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(scenes_are_found_by_name_and_by_file),
		cmocka_unit_test(what_cannot_be_read_is_named),
	};
	return cmocka_run_group_tests(tests, NULL, fixture_remove);
}

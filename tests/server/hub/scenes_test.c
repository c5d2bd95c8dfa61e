// SPDX-License-Identifier: GPL-3.0-or-later
#include "hub/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static void every_scene_of_the_folder_is_there_by_name(void **state)
{
	(void)state;
	cau_scenes *scenes;
	cau_error error = {0};
	assert_int_equal(cau_scenes_load(&scenes, CAU_TEST_SCENES, &error), CAU_OK);
	assert_true(cau_scenes_count(scenes) >= 5);
	for (int32_t i = 1; i < cau_scenes_count(scenes); i++)
		assert_true(strcmp(cau_scenes_at(scenes, i - 1)->name, cau_scenes_at(scenes, i)->name) < 0);
	assert_non_null(cau_scenes_find(scenes, "layers"));
	assert_string_equal(cau_scenes_find(scenes, "layers")->directory, CAU_TEST_SCENES);
	assert_null(cau_scenes_find(scenes, "lay"));
	cau_scenes_destroy(scenes);
	cau_scenes_destroy(NULL);
}

static void a_file_that_is_no_scene_is_named(void **state)
{
	(void)state;
	char folder[] = "/tmp/cautery-scenes-XXXXXX", path[64];
	cau_scenes *scenes;
	cau_error error = {0};
	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/bad.json", folder);
	FILE *stream = fopen(path, "w");
	fputs("{\"name\": 7}", stream);
	fclose(stream);
	assert_int_equal(cau_scenes_load(&scenes, folder, &error), CAU_BAD_VALUE);
	assert_non_null(strstr(error.file, "bad.json"));
	assert_null(scenes);
	unlink(path);
	assert_int_equal(cau_scenes_load(&scenes, folder, &error), CAU_OK);
	assert_int_equal(cau_scenes_count(scenes), 0);
	cau_scenes_destroy(scenes);
	rmdir(folder);
	assert_int_equal(cau_scenes_load(&scenes, folder, &error), CAU_IO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_scene_of_the_folder_is_there_by_name),
		cmocka_unit_test(a_file_that_is_no_scene_is_named),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

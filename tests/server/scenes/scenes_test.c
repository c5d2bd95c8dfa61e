// SPDX-License-Identifier: GPL-3.0-or-later
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

typedef struct names {
	int count;
	char last[CAU_NAME_BYTES];
	bool ascend;
} names;

static void note(void *user, const cau_scene_def *scene)
{
	names *seen = user;
	seen->ascend &= strcmp(seen->last, scene->name) < 0;
	memcpy(seen->last, scene->name, sizeof seen->last);
	seen->count++;
}

static names names_of(cau_scenes *scenes)
{
	names seen = {.ascend = true};
	cau_scenes_each(scenes, note, &seen);
	return seen;
}

static void every_scene_of_the_folder_is_there_by_name(void **state)
{
	(void)state;
	cau_scenes *scenes;
	cau_error error = {0};
	cau_scene_def *copy = malloc(sizeof *copy);
	assert_int_equal(cau_scenes_load(&scenes, CAU_TEST_SCENES, &error), CAU_OK);
	names seen = names_of(scenes);
	assert_true(seen.count >= 5 && seen.ascend);
	assert_true(cau_scenes_copy(scenes, "layers", copy));
	assert_string_equal(copy->name, "layers");
	assert_string_equal(copy->directory, CAU_TEST_SCENES);
	assert_false(cau_scenes_copy(scenes, "lay", copy));
	cau_scenes_destroy(scenes);
	cau_scenes_destroy(NULL);
	free(copy);
}

static void write_text(const char *folder, const char *name, const char *text)
{
	char path[128];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *stream = fopen(path, "w");
	assert_non_null(stream);
	fputs(text, stream);
	fclose(stream);
}

static char *read_text(const char *path)
{
	char *text = calloc(1, 1 << 20);
	FILE *stream = fopen(path, "r");
	assert_non_null(stream);
	assert_true(fread(text, 1, (1 << 20) - 1, stream) > 0);
	fclose(stream);
	return text;
}

static void files_that_come_and_go_are_followed(void **state)
{
	(void)state;
	char folder[] = "/tmp/cautery-scenes-XXXXXX", path[128];
	cau_scenes *scenes;
	cau_error error = {0};
	bool changed;
	char *fat = read_text(CAU_TEST_SCENES "/fat.json"),
		 *layers = read_text(CAU_TEST_SCENES "/layers.json");
	assert_non_null(mkdtemp(folder));
	write_text(folder, "one.json", fat);
	assert_int_equal(cau_scenes_load(&scenes, folder, &error), CAU_OK);
	assert_int_equal(cau_scenes_follow(scenes, &changed, &error), CAU_OK);
	assert_false(changed);
	assert_int_equal(cau_scenes_edition(scenes), 0);
	write_text(folder, "two.json", layers);
	assert_int_equal(cau_scenes_follow(scenes, &changed, &error), CAU_OK);
	assert_true(changed);
	assert_int_equal(cau_scenes_edition(scenes), 1);
	assert_int_equal(names_of(scenes).count, 2);
	write_text(folder, "two.json", "{\"name\": ");
	assert_int_not_equal(cau_scenes_follow(scenes, &changed, &error), CAU_OK);
	assert_non_null(strstr(error.file, "two.json"));
	assert_int_equal(names_of(scenes).count, 2);
	assert_int_equal(cau_scenes_follow(scenes, &changed, &error),
	                 CAU_OK); // an error is reported once
	assert_false(changed);
	snprintf(path, sizeof path, "%s/two.json", folder);
	unlink(path);
	assert_int_equal(cau_scenes_follow(scenes, &changed, &error), CAU_OK);
	assert_true(changed);
	assert_int_equal(names_of(scenes).count, 1);
	snprintf(path, sizeof path, "%s/one.json", folder);
	unlink(path);
	rmdir(folder);
	assert_int_equal(cau_scenes_follow(scenes, &changed, &error), CAU_IO);
	assert_int_equal(names_of(scenes).count, 1);
	cau_scenes_destroy(scenes);
	free(fat);
	free(layers);
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
	assert_int_equal(names_of(scenes).count, 0);
	cau_scenes_destroy(scenes);
	rmdir(folder);
	assert_int_equal(cau_scenes_load(&scenes, folder, &error), CAU_IO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_scene_of_the_folder_is_there_by_name),
		cmocka_unit_test(files_that_come_and_go_are_followed),
		cmocka_unit_test(a_file_that_is_no_scene_is_named),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

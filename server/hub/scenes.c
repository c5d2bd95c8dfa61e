// SPDX-License-Identifier: GPL-3.0-or-later
#include "hub/scenes.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/scene_json.h"
#include "config/named_file.h"

enum { MOST_SCENES = 256, PATH_BYTES = 1024 };

struct cau_scenes {
	int32_t count;
	cau_scene_def *scenes[MOST_SCENES];
};

static int is_scene(const struct dirent *entry)
{
	const char *ending = strrchr(entry->d_name, '.');
	return entry->d_name[0] != '.' && ending && strcmp(ending, ".json") == 0;
}

static cau_status read_text(const char *path, char *text, size_t *bytes, cau_error *error)
{
	char reason[CAU_NAMED_FILE_REASON_BYTES];
	FILE *stream = cau_named_file_open(path, CAU_SCENE_JSON_MAX_BYTES, NULL, reason);
	if (!stream)
		return cau_fail(error, CAU_IO, "scenes", "cannot open %.160s: %s", path, reason);
	*bytes = fread(text, 1, CAU_SCENE_JSON_MAX_BYTES + 1, stream);
	fclose(stream);
	return CAU_OK;
}

static cau_status read_scene(cau_scenes *scenes, const char *folder, const char *name, char *text,
                             cau_error *error)
{
	char path[PATH_BYTES];
	size_t bytes = 0;
	cau_scene_def *scene = malloc(sizeof *scene);
	if (!scene)
		return cau_fail(error, CAU_NO_MEMORY, "scenes", "no memory");
	snprintf(path, sizeof path, "%s/%s", folder, name);
	cau_status status = read_text(path, text, &bytes, error);
	if (!status)
		status = cau_scene_from_json(path, text, bytes, scene, error);
	if (status) {
		free(scene);
		return status;
	}
	snprintf(scene->directory, sizeof scene->directory, "%s", folder);
	scenes->scenes[scenes->count++] = scene;
	return CAU_OK;
}

static int by_name(const void *a, const void *b)
{
	const cau_scene_def *const *left = a, *const *right = b;
	return strcmp((*left)->name, (*right)->name);
}

cau_status cau_scenes_load(cau_scenes **made, const char *folder, cau_error *error)
{
	*made = NULL;
	struct dirent **entries = NULL;
	int count = scandir(folder, &entries, is_scene, alphasort);
	if (count < 0)
		return cau_fail(error, CAU_IO, "scenes", "cannot read the folder %.250s", folder);
	char *text = malloc(CAU_SCENE_JSON_MAX_BYTES + 1);
	cau_scenes *scenes = calloc(1, sizeof *scenes);
	cau_status status = text && scenes ? CAU_OK : CAU_NO_MEMORY;
	for (int i = 0; i < count; i++) {
		if (!status && scenes->count < MOST_SCENES)
			status = read_scene(scenes, folder, entries[i]->d_name, text, error);
		free(entries[i]);
	}
	if (scenes)
		qsort(scenes->scenes, (size_t)scenes->count, sizeof scenes->scenes[0], by_name);
	free(entries);
	free(text);
	if (status)
		cau_scenes_destroy(scenes);
	else
		*made = scenes;
	return status;
}

void cau_scenes_destroy(cau_scenes *scenes)
{
	for (int32_t i = 0; scenes && i < scenes->count; i++)
		free(scenes->scenes[i]);
	free(scenes);
}

int32_t cau_scenes_count(const cau_scenes *scenes)
{
	return scenes->count;
}

const cau_scene_def *cau_scenes_at(const cau_scenes *scenes, int32_t index)
{
	return scenes->scenes[index];
}

const cau_scene_def *cau_scenes_find(const cau_scenes *scenes, const char *name)
{
	for (int32_t i = 0; i < scenes->count; i++)
		if (strcmp(scenes->scenes[i]->name, name) == 0)
			return scenes->scenes[i];
	return NULL;
}

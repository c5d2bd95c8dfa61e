// SPDX-License-Identifier: GPL-3.0-or-later
// The named scenes of a folder, and the uploaded meshes of scenes.
#include "scenes/scenes.h"

#include <dirent.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cautery/scene_json.h"
#include "config/config.h"

// ---- named scenes
enum { MOST_SCENES = 256, PATH_BYTES = 1024 };

// The scenes of one reading of the folder.
typedef struct edition {
	int32_t count;
	cau_scene_def *scenes[MOST_SCENES];
} edition;

struct cau_scenes {
	char folder[PATH_BYTES];
	uint64_t stamp; // stamp of the folder at the last reading; used by one thread only

	pthread_mutex_t mutex; // guards the members below
	edition *now;
	uint64_t number; // number of the present edition
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

static cau_status read_scene(edition *scenes, const char *folder, const char *name, char *text,
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

static void free_edition(edition *scenes)
{
	for (int32_t i = 0; scenes && i < scenes->count; i++)
		free(scenes->scenes[i]);
	free(scenes);
}

static cau_status read_all(const char *folder, struct dirent **entries, int count, edition *scenes,
                           cau_error *error)
{
	cau_status status = CAU_OK;
	char *text = malloc(CAU_SCENE_JSON_MAX_BYTES + 1);
	if (!text)
		return cau_fail(error, CAU_NO_MEMORY, "scenes", "no memory");
	for (int i = 0; i < count && !status && scenes->count < MOST_SCENES; i++)
		status = read_scene(scenes, folder, entries[i]->d_name, text, error);
	qsort(scenes->scenes, (size_t)scenes->count, sizeof scenes->scenes[0], by_name);
	free(text);
	return status;
}

// Adds bytes to a hash (FNV-1a) of what changes when a file is replaced.
static uint64_t hash(uint64_t sum, const void *bytes, size_t count)
{
	for (const unsigned char *b = bytes; count; b++, count--)
		sum = (sum ^ *b) * UINT64_C(0x100000001B3);
	return sum;
}

static uint64_t stamp_of(const char *folder, struct dirent **entries, int count)
{
	uint64_t sum = UINT64_C(0xCBF29CE484222325);
	for (int i = 0; i < count; i++) {
		char path[PATH_BYTES + 256];
		struct stat file = {0};
		snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
		if (stat(path, &file))
			memset(&file, 0, sizeof file);
		sum = hash(sum, entries[i]->d_name, strlen(entries[i]->d_name));
		sum = hash(sum, &file.st_mtim, sizeof file.st_mtim);
		sum = hash(sum, &file.st_size, sizeof file.st_size);
		sum = hash(sum, &file.st_ino, sizeof file.st_ino);
	}
	return sum;
}

static void free_entries(struct dirent **entries, int count)
{
	for (int i = 0; i < count; i++)
		free(entries[i]);
	free(entries);
}

// Reads the folder if its stamp differs from *stamp, and updates *stamp. If the stamp is the same,
// *made is NULL.
static cau_status read_folder(const char *folder, uint64_t *stamp, edition **made, cau_error *error)
{
	struct dirent **entries = NULL;
	int count = scandir(folder, &entries, is_scene, alphasort);
	*made = NULL;
	if (count < 0)
		return cau_fail(error, CAU_IO, "scenes", "cannot read the folder %.250s", folder);
	uint64_t before = *stamp;
	*stamp = stamp_of(folder, entries, count);
	cau_status status = CAU_OK;
	edition *scenes = *stamp == before ? NULL : calloc(1, sizeof *scenes);
	if (scenes)
		status = read_all(folder, entries, count, scenes, error);
	else if (*stamp != before)
		status = cau_fail(error, CAU_NO_MEMORY, "scenes", "no memory");
	free_entries(entries, count);
	if (status)
		free_edition(scenes);
	else
		*made = scenes;
	return status;
}

cau_status cau_scenes_load(cau_scenes **made, const char *folder, cau_error *error)
{
	cau_scenes *scenes = calloc(1, sizeof *scenes);
	*made = NULL;
	if (!scenes)
		return cau_fail(error, CAU_NO_MEMORY, "scenes", "no memory");
	pthread_mutex_init(&scenes->mutex, NULL);
	snprintf(scenes->folder, sizeof scenes->folder, "%s", folder);
	cau_status status = read_folder(folder, &scenes->stamp, &scenes->now, error);
	if (status)
		cau_scenes_destroy(scenes);
	else
		*made = scenes;
	return status;
}

void cau_scenes_destroy(cau_scenes *scenes)
{
	if (!scenes)
		return;
	free_edition(scenes->now);
	pthread_mutex_destroy(&scenes->mutex);
	free(scenes);
}

cau_status cau_scenes_follow(cau_scenes *scenes, bool *changed, cau_error *error)
{
	edition *next;
	cau_status status = read_folder(scenes->folder, &scenes->stamp, &next, error);
	*changed = next;
	if (!next)
		return status;
	pthread_mutex_lock(&scenes->mutex);
	edition *before = scenes->now;
	scenes->now = next;
	scenes->number++;
	pthread_mutex_unlock(&scenes->mutex);
	free_edition(before);
	return CAU_OK;
}

uint64_t cau_scenes_edition(cau_scenes *scenes)
{
	pthread_mutex_lock(&scenes->mutex);
	uint64_t number = scenes->number;
	pthread_mutex_unlock(&scenes->mutex);
	return number;
}

void cau_scenes_each(cau_scenes *scenes, void (*visit)(void *user, const cau_scene_def *scene),
                     void *user)
{
	pthread_mutex_lock(&scenes->mutex);
	for (int32_t i = 0; i < scenes->now->count; i++)
		visit(user, scenes->now->scenes[i]);
	pthread_mutex_unlock(&scenes->mutex);
}

bool cau_scenes_copy(cau_scenes *scenes, const char *name, cau_scene_def *copy)
{
	bool found = false;
	pthread_mutex_lock(&scenes->mutex);
	for (int32_t i = 0; i < scenes->now->count && !found; i++) {
		found = strcmp(scenes->now->scenes[i]->name, name) == 0;
		if (found)
			*copy = *scenes->now->scenes[i];
	}
	pthread_mutex_unlock(&scenes->mutex);
	return found;
}

// ---- uploaded meshes
// Uploaded meshes are packed into one block, which the store keeps with the session. For each mesh
// of source bytes, in the scene's order, the block has a u64 length and the bytes.

static bool is_uploaded(const cau_mesh_def *mesh)
{
	return mesh->source == CAU_MESH_BYTES;
}

cau_status cau_meshes_pack(cau_scene_def *scene, void **meshes, size_t *bytes, cau_error *error)
{
	*meshes = NULL;
	*bytes = 0;
	for (int32_t i = 0; i < scene->mesh_count; i++)
		if (is_uploaded(&scene->meshes[i]))
			*bytes += sizeof(uint64_t) + scene->meshes[i].byte_count;
	if (!*bytes)
		return CAU_OK;
	char *block = malloc(*bytes), *at = block;
	if (!block)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for the meshes");
	for (int32_t i = 0; i < scene->mesh_count; i++) {
		cau_mesh_def *mesh = &scene->meshes[i];
		if (!is_uploaded(mesh))
			continue;
		uint64_t length = mesh->byte_count;
		memcpy(at, &length, sizeof length);
		memcpy(at + sizeof length, mesh->bytes, mesh->byte_count);
		mesh->bytes = at + sizeof length;
		at += sizeof length + mesh->byte_count;
	}
	*meshes = block;
	return CAU_OK;
}

cau_status cau_meshes_unpack(cau_scene_def *scene, const void *meshes, size_t bytes,
                             cau_error *error)
{
	const char *at = meshes;
	size_t left = bytes;
	for (int32_t i = 0; i < scene->mesh_count; i++) {
		cau_mesh_def *mesh = &scene->meshes[i];
		uint64_t length = 0;
		if (!is_uploaded(mesh))
			continue;
		if (left >= sizeof length)
			memcpy(&length, at, sizeof length);
		if (left < sizeof length || length > left - sizeof length)
			return cau_fail(error, CAU_CORRUPT, "", "the stored meshes are cut short");
		mesh->bytes = at + sizeof length;
		mesh->byte_count = length;
		at += sizeof length + length;
		left -= sizeof length + length;
	}
	return left ? cau_fail(error, CAU_CORRUPT, "",
	                       "the stored meshes have %zu bytes more than the scene's meshes need",
	                       left)
	            : CAU_OK;
}

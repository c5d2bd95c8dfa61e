// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene_source.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cautery/name.h"
#include "cautery/scene_json.h"
#include "places/places.h"
#include "sim/mesh_scene.h"

enum { PATH_BYTES = 1024 };

static cau_status fail_file(const char *path, const char *doing, cau_error *error)
{
	const char *reason = strerror(errno);
	snprintf(error->file, sizeof error->file, "%.255s", path);
	return cau_fail(error, CAU_IO, NULL, "cannot %s: %s", doing, reason);
}

cau_status sim_read_file(const char *path, size_t most, char **text, size_t *bytes,
                         cau_error *error)
{
	*text = NULL;
	cau_status status = CAU_OK;
	struct stat info;
	FILE *file = fopen(path, "rb");
	if (!file)
		return fail_file(path, "open", error);
	if (fstat(fileno(file), &info) != 0 || !S_ISREG(info.st_mode)) {
		errno = S_ISDIR(info.st_mode) ? EISDIR : EINVAL;
		status = fail_file(path, "read", error);
		goto close;
	}
	if ((uint64_t)info.st_size > most) {
		snprintf(error->file, sizeof error->file, "%.255s", path);
		status = cau_fail(error, CAU_LIMIT, NULL, "%lld bytes, the limit is %zu",
		                  (long long)info.st_size, most);
		goto close;
	}
	*text = malloc((size_t)info.st_size + 1);
	if (!*text) {
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %s", path);
		goto close;
	}
	*bytes = fread(*text, 1, (size_t)info.st_size, file);
	(*text)[*bytes] = 0;
	if (ferror(file)) {
		status = fail_file(path, "read", error);
		free(*text);
		*text = NULL;
	}
close:
	fclose(file);
	return status;
}

static bool ends_with(const char *text, const char *ending)
{
	size_t bytes = strlen(text), tail = strlen(ending);
	return bytes >= tail && strcmp(text + bytes - tail, ending) == 0;
}

// The folder of `path` into scene->directory, where its relative mesh files are looked up.
static cau_status set_directory(const char *path, cau_scene_def *scene, cau_error *error)
{
	const char *slash = strrchr(path, '/');
	size_t bytes = slash == path ? 1 : slash ? (size_t)(slash - path) : 0;
	if (bytes >= sizeof scene->directory)
		return cau_fail(error, CAU_LIMIT, NULL, "a folder name of more than %zu bytes",
		                sizeof scene->directory - 1);
	memcpy(scene->directory, path, bytes);
	scene->directory[bytes] = 0;
	return CAU_OK;
}

static cau_status load_file(const char *path, cau_scene_def *scene, cau_error *error)
{
	char *text;
	size_t bytes;
	cau_status status = sim_read_file(path, CAU_SCENE_JSON_MAX_BYTES, &text, &bytes, error);
	if (status)
		return status;
	status = cau_scene_from_json(path, text, bytes, scene, error);
	free(text);
	return status ? status : set_directory(path, scene, error);
}

static cau_status load_name(const char *name, const char *folder, cau_scene_def *scene,
                            cau_error *error)
{
	char path[PATH_BYTES], installed[PATH_BYTES];
	if (strlen(name) >= CAU_NAME_BYTES || !cau_name_is_valid(name))
		return cau_fail(error, CAU_BAD_VALUE, NULL, "\"%.100s\" is no scene name (%s) and no file",
		                name, CAU_NAME_RULE);
	if (!folder && !cau_place_find("scenes", installed, sizeof installed))
		return cau_fail(error, CAU_NOT_FOUND, NULL,
		                "no folder ../share/cautery/scenes beside this program: say --scenes DIR");
	if (!folder)
		folder = installed;
	int bytes = snprintf(path, sizeof path, "%s/%s.json", folder, name);
	if (bytes < 0 || (size_t)bytes >= sizeof path)
		return cau_fail(error, CAU_LIMIT, NULL, "the folder's name is too long");
	if (access(path, F_OK) != 0)
		return cau_fail(error, CAU_NOT_FOUND, NULL, "no scene \"%s\" in %s", name, folder);
	return load_file(path, scene, error);
}

cau_status sim_scene_load(const char *source, const char *folder, double unit_m, bool strict,
                          cau_scene_def *scene, cau_error *error)
{
	struct stat about;
	if (ends_with(source, ".json"))
		return load_file(source, scene, error);
	if (stat(source, &about) == 0 && S_ISREG(about.st_mode))
		return sim_mesh_scene(
			&(cau_mesh_wish){.file = source, .unit_m = unit_m, .strict = strict, .layer_kind = -1},
			scene, error);
	return load_name(source, folder, scene, error);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene_source.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cautery/embed.h"
#include "cautery/name.h"
#include "places/places.h"
#include "sim/mesh_scene.h"

enum { PATH_BYTES = 1024 };

static bool ends_with(const char *text, const char *ending)
{
	size_t bytes = strlen(text), tail = strlen(ending);
	return bytes >= tail && strcmp(text + bytes - tail, ending) == 0;
}

static cau_status load_name(const char *name, const char *folder, cau_scene_def *scene,
                            cau_error *error)
{
	char path[PATH_BYTES], installed[PATH_BYTES];
	if (strlen(name) >= CAU_NAME_BYTES || !cau_name_is_valid(name))
		return cau_fail(error, CAU_BAD_VALUE, NULL,
		                "\"%.100s\" is neither the name of a scene (%s) nor a file", name,
		                CAU_NAME_RULE);
	if (!folder && !cau_place_find("scenes", installed, sizeof installed))
		return cau_fail(
			error, CAU_NOT_FOUND, NULL,
			"the folder ../share/cautery/scenes beside this program is missing: give --scenes DIR");
	if (!folder)
		folder = installed;
	int bytes = snprintf(path, sizeof path, "%s/%s.json", folder, name);
	if (bytes < 0 || (size_t)bytes >= sizeof path)
		return cau_fail(error, CAU_LIMIT, NULL, "the folder's name is too long");
	if (access(path, F_OK) != 0)
		return cau_fail(error, CAU_NOT_FOUND, NULL, "no scene \"%s\" in %s", name, folder);
	return cau_scene_from_file(path, scene, error);
}

cau_status sim_scene_load(const char *source, const char *folder, double unit_m, bool strict,
                          cau_scene_def *scene, cau_error *error)
{
	struct stat about;
	if (ends_with(source, ".json"))
		return cau_scene_from_file(source, scene, error);
	if (stat(source, &about) == 0 && S_ISREG(about.st_mode))
		return sim_mesh_scene(
			&(cau_mesh_wish){.file = source, .unit_m = unit_m, .strict = strict, .layer_kind = -1},
			scene, error);
	return load_name(source, folder, scene, error);
}

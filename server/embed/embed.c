// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/embed.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/command_json.h"
#include "cautery/scene_json.h"
#include "embed/whole_file.h"

const char *cau_core_version(void)
{
	return CAUTERY_VERSION;
}

static cau_status set_directory(const char *folder, size_t bytes, cau_scene_def *scene,
                                cau_error *error)
{
	if (bytes >= sizeof scene->directory)
		return cau_fail(error, CAU_LIMIT, NULL, "a folder name of more than %zu bytes",
		                sizeof scene->directory - 1);
	memcpy(scene->directory, folder, bytes);
	scene->directory[bytes] = 0;
	return CAU_OK;
}

// Sets scene->directory to the folder of `path`, in which relative names of mesh files are found.
static cau_status set_folder_of(const char *path, cau_scene_def *scene, cau_error *error)
{
	const char *slash = strrchr(path, '/');
	size_t bytes = slash == path ? 1 : slash ? (size_t)(slash - path) : 0;
	return set_directory(path, bytes, scene, error);
}

cau_status cau_scene_from_file(const char *path, cau_scene_def *scene, cau_error *error)
{
	char *text;
	size_t bytes;
	cau_status status = embed_read_file(path, CAU_SCENE_JSON_MAX_BYTES, &text, &bytes, error);
	if (status)
		return status;
	status = cau_scene_from_json(path, text, bytes, scene, error);
	free(text);
	return status ? status : set_folder_of(path, scene, error);
}

// Allocates a scene, which the caller frees. A scene is too large for the stack.
static cau_scene_def *new_scene(cau_error *error)
{
	cau_scene_def *scene = malloc(sizeof *scene);
	if (!scene)
		cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a scene");
	return scene;
}

static cau_status create(const char *name, const cau_scene_def *scene,
                         const cau_session_def *wanted, cau_session **session, cau_error *error)
{
	cau_session_def def = wanted ? *wanted : cau_default_session_def();
	def.scene = scene;
	if (error)
		error->file[0] = 0; // the core sets the file if a mesh file is wrong
	cau_status status = cau_session_create(&def, session, error);
	if (status && error && !error->file[0])
		snprintf(error->file, sizeof error->file, "%.255s", name ? name : "");
	return status;
}

cau_status cau_session_from_file(const char *path, const cau_session_def *def,
                                 cau_session **session, cau_error *error)
{
	cau_scene_def *scene = new_scene(error);
	if (!scene)
		return CAU_NO_MEMORY;
	cau_status status = cau_scene_from_file(path, scene, error);
	if (!status)
		status = create(path, scene, def, session, error);
	free(scene);
	return status;
}

cau_status cau_session_from_json(const char *name, const char *text, size_t byte_count,
                                 const char *directory, const cau_session_def *def,
                                 cau_session **session, cau_error *error)
{
	cau_scene_def *scene = new_scene(error);
	if (!scene)
		return CAU_NO_MEMORY;
	cau_status status = cau_scene_from_json(name, text, byte_count, scene, error);
	if (!status && directory)
		status = set_directory(directory, strlen(directory), scene, error);
	if (!status)
		status = create(name, scene, def, session, error);
	free(scene);
	return status;
}

cau_status cau_session_submit_json(cau_session *session, const char *text, size_t byte_count,
                                   cau_error *error)
{
	cau_command command;
	cau_status status = cau_command_from_json(text, byte_count, &command, error);
	return status ? status : cau_session_submit(session, &command, error);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// A folder for the files of one test program, and a small scene.
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "cautery/status.h"

static inline const char *fixture_folder(void)
{
	static char folder[] = "/tmp/cautery-sim-XXXXXX";
	static const char *made = NULL;
	if (!made)
		made = mkdtemp(folder);
	assert_non_null(made);
	return made;
}

static inline const char *fixture_path(const char *name)
{
	static char path[4][256];
	static int turn = 0;
	turn = (turn + 1) % 4;
	snprintf(path[turn], sizeof path[turn], "%s/%s", fixture_folder(), name);
	return path[turn];
}

static inline void fixture_write(const char *path, const char *text)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

// Reads a file. The caller frees the text, which has a zero at its end.
static inline char *fixture_read(const char *path, size_t *bytes)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	assert_int_equal(fseek(file, 0, SEEK_END), 0);
	*bytes = (size_t)ftell(file);
	rewind(file);
	char *text = malloc(*bytes + 1);
	assert_non_null(text);
	assert_int_equal(fread(text, 1, *bytes, file), *bytes);
	text[*bytes] = 0;
	fclose(file);
	return text;
}

// Returns a scene with one layer and one hook above it.
static inline cau_scene_def *fixture_scene(void)
{
	cau_scene_def *scene = malloc(sizeof *scene);
	assert_non_null(scene);
	cau_default_scene_def(scene);
	snprintf(scene->name, sizeof scene->name, "small");
	scene->mesh_count = 1;
	cau_default_mesh_def(&scene->meshes[0]);
	snprintf(scene->meshes[0].name, CAU_NAME_BYTES, "sheet");
	scene->layer_count = 1;
	cau_default_layer_def(&scene->layers[0], CAU_LAYER_FASCIA);
	snprintf(scene->layers[0].name, CAU_NAME_BYTES, "fascia");
	snprintf(scene->layers[0].mesh, CAU_NAME_BYTES, "sheet");
	scene->tool_count = 1;
	cau_default_tool_def(&scene->tools[0], CAU_TOOL_HOOK);
	snprintf(scene->tools[0].name, CAU_NAME_BYTES, "hook");
	return scene;
}

// Removes the folder with everything in it.
static inline int fixture_remove(void **state)
{
	(void)state;
	char command[300];
	snprintf(command, sizeof command, "rm -rf %s", fixture_folder());
	return system(command);
}

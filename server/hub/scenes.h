// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes that sessions can be made from by name: the JSON files of one folder, read at start.
#pragma once

#include "cautery/scene.h"
#include "cautery/status.h"

typedef struct cau_scenes cau_scenes;

// Reads every *.json of the folder, at most 256; a file that is no scene is an error that names it.
cau_status cau_scenes_load(cau_scenes **scenes, const char *folder, cau_error *error);
void cau_scenes_destroy(cau_scenes *scenes); // takes NULL

int32_t cau_scenes_count(const cau_scenes *scenes);
const cau_scene_def *cau_scenes_at(const cau_scenes *scenes, int32_t index);      // by name
const cau_scene_def *cau_scenes_find(const cau_scenes *scenes, const char *name); // or NULL

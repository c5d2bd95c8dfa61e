// SPDX-License-Identifier: GPL-3.0-or-later
// The named scenes from which sessions can be created: the JSON files of one folder. They are read
// at the start, and again when files are added, changed or removed. Any thread may use them.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/scene.h"
#include "cautery/status.h"

typedef struct cau_scenes cau_scenes;

// Reads every *.json file of the folder, at most 256. If a file is not a scene, fails with an error
// that names the file.
cau_status cau_scenes_load(cau_scenes **scenes, const char *folder, cau_error *error);
void cau_scenes_destroy(cau_scenes *scenes); // `scenes` may be NULL

// Reads the folder again if its files changed since the last call. *changed: the scenes were
// replaced. After an error the old scenes stay. This reads files, so call it from a thread for
// which no other thread waits.
cau_status cau_scenes_follow(cau_scenes *scenes, bool *changed, cau_error *error);
// Returns a number that changes whenever the scenes change.
uint64_t cau_scenes_edition(cau_scenes *scenes);

// Visits all scenes, ordered by name. A lock is held meanwhile, so the visitor must not call these
// functions.
void cau_scenes_each(cau_scenes *scenes, void (*visit)(void *user, const cau_scene_def *scene),
                     void *user);
// Copies a scene. Returns false if no scene has this name.
bool cau_scenes_copy(cau_scenes *scenes, const char *name, cau_scene_def *copy);

// ---- uploaded meshes of a scene

// cau_meshes_pack packs the bytes of a scene's uploaded meshes into one allocation, to which the
// scene's meshes then point. *meshes is NULL if the scene has none. The function cau_meshes_unpack
// does the reverse, after both were read from the store.
cau_status cau_meshes_pack(cau_scene_def *scene, void **meshes, size_t *bytes, cau_error *error);
cau_status cau_meshes_unpack(cau_scene_def *scene, const void *meshes, size_t bytes,
                             cau_error *error);

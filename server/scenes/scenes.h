// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes that sessions can be made from by name: the JSON files of one folder. They are read at
// the start, and again when files are added, changed or removed. Any thread.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/scene.h"
#include "cautery/status.h"

typedef struct cau_scenes cau_scenes;

// Reads every *.json of the folder, at most 256; a file that is no scene is an error that names it.
cau_status cau_scenes_load(cau_scenes **scenes, const char *folder, cau_error *error);
void cau_scenes_destroy(cau_scenes *scenes); // takes NULL

// Reads the folder again if its files changed since the last call. *changed: whether the scenes
// were replaced. After an error the old scenes stay. It reads files: call it from a thread for
// which no other waits.
cau_status cau_scenes_follow(cau_scenes *scenes, bool *changed, cau_error *error);
// Another number whenever they have changed.
uint64_t cau_scenes_edition(cau_scenes *scenes);

// Visits all, by name; the visitor is under a lock, and must not call these functions.
void cau_scenes_each(cau_scenes *scenes, void (*visit)(void *user, const cau_scene_def *scene),
                     void *user);
// False: there is no such scene.
bool cau_scenes_copy(cau_scenes *scenes, const char *name, cau_scene_def *copy);

// ---- uploaded meshes of a scene

// Packs the bytes of a scene's uploaded meshes into one allocation and points the scene there;
// *meshes is NULL if it has none. And back, after reading both from the store.
cau_status cau_meshes_pack(cau_scene_def *scene, void **meshes, size_t *bytes, cau_error *error);
cau_status cau_meshes_unpack(cau_scene_def *scene, const void *meshes, size_t bytes,
                             cau_error *error);

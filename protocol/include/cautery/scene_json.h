// SPDX-License-Identifier: Apache-2.0
// Scenes as JSON. Names are the field names of cautery/scene.h, choices are the JSON names of its
// tables; deploy/scenes/README.md lists all of them. Absent members keep their defaults
// (cautery/defaults.h; a layer's by its kind), unknown ones are errors. A layer's own material
// stands among its members; "regions": [{"region": 3, ...}] holds what differs in regions of the
// mesh file.
//
//     #include "cautery/scene_json.h"
//
//     // Every member of a scene, those that its text leaves out too.
//     static cau_status complete(const char *text, size_t bytes, cau_scene_def *scene,
//                                char *buffer, size_t capacity, cau_error *error)
//     {
//         cau_status status = cau_scene_from_json("scene.json", text, bytes, scene, error);
//         return status ? status : cau_scene_to_json(scene, buffer, capacity, NULL, error);
//     }
#pragma once

#include <stddef.h>

#include "cautery/scene.h"
#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CAU_SCENE_JSON_MAX_BYTES = 1 << 20 }; // of one scene as text

// Fills *scene from the text. `name` (a file's, say; may be NULL) goes into error->file. Checks
// types, ranges, names and what belongs to which kind; references between members are
// cau_scene_check's business. scene->directory is left empty: set it where meshes come from files.
// On an error *scene holds nothing useful. Errors: CAU_BAD_SYNTAX, CAU_LIMIT, CAU_NO_MEMORY,
// CAU_BAD_VALUE with the path of the member ("layers[1].poisson_ratio") and a reason that names the
// allowed range and the unit.
cau_status cau_scene_from_json(const char *name, const char *text, size_t bytes,
                               cau_scene_def *scene, cau_error *error);

// Writes every member, defaults too: reading it back gives an equal *scene (but for the directory
// and the bytes of uploaded meshes). *bytes (may be NULL) is the text's length without its closing
// zero, also when it did not fit. Errors: CAU_LIMIT (capacity), CAU_BAD_VALUE (the scene has a
// value that JSON cannot hold).
cau_status cau_scene_to_json(const cau_scene_def *scene, char *buffer, size_t capacity,
                             size_t *bytes, cau_error *error);

#ifdef __cplusplus
}
#endif

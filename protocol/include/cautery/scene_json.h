// SPDX-License-Identifier: Apache-2.0
// Scenes as JSON. Names are the field names of cautery/scene.h. Choices are the JSON names of its
// tables. deploy/scenes/README.md lists all of them. Absent members get their defaults
// (cautery/defaults.h; for a layer, the defaults of its kind). Unknown members are errors. The
// members of a layer include the layer's own material. The layer's member "regions": [{"region": 3,
// ...}] has the differences in regions of the mesh file.
//
//     #include "cautery/scene_json.h"
//
//     // Writes every member of a scene, including those that its text leaves out.
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

enum { CAU_SCENE_JSON_MAX_BYTES = 1 << 20 }; // largest text of one scene

// Fills *scene from the text. `name`, such as a file name, is copied to error->file; it may be
// NULL. Checks types, ranges, names, and whether members fit their kind. cau_scene_check checks
// references between members. scene->directory is left empty: set it if meshes come from files.
// After an error *scene is invalid. Errors: CAU_BAD_SYNTAX, CAU_LIMIT, CAU_NO_MEMORY, CAU_BAD_VALUE
// with the path of the member ("layers[1].poisson_ratio") and a reason that names the allowed range
// and the unit.
cau_status cau_scene_from_json(const char *name, const char *text, size_t bytes,
                               cau_scene_def *scene, cau_error *error);

// Writes every member, including defaults. Reading the text gives an equal *scene, except for the
// directory and the bytes of uploaded meshes. *bytes (may be NULL) is the length without the
// closing zero, even if the text did not fit. Errors: CAU_LIMIT (capacity), CAU_BAD_VALUE (the
// scene has a value that JSON cannot represent).
cau_status cau_scene_to_json(const cau_scene_def *scene, char *buffer, size_t capacity,
                             size_t *bytes, cau_error *error);

#ifdef __cplusplus
}
#endif

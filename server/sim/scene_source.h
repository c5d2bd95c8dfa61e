// SPDX-License-Identifier: GPL-3.0-or-later
// Finds and reads scenes: by name in a folder, from a file, or made around a mesh file.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/scene.h"
#include "cautery/status.h"

// Reads a whole file of at most `most` bytes; the caller frees *text, which ends with a zero byte.
cau_status sim_read_file(const char *path, size_t most, char **text, size_t *bytes,
                         cau_error *error);

// Fills *scene from `source`: a file that ends in .json, any other file as a mesh (units of unit_m
// metres, 0: guessed; strict: refused where it needs mending), or a name in `folder` (NULL: the
// installed scenes, or the source's where none are). Errors name file, path and reason.
cau_status sim_scene_load(const char *source, const char *folder, double unit_m, bool strict,
                          cau_scene_def *scene, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// Finds and reads scenes: by name in a folder, from a file, or made around a mesh file.
#pragma once

#include <stdbool.h>

#include "cautery/scene.h"
#include "cautery/status.h"

// Fills *scene from `source`: a file that ends in .json, any other file as a mesh (units of unit_m
// metres, 0: guessed; strict: refused where it needs mending), or a name in `folder` (NULL: the
// installed scenes, or the source's where none are). Errors name file, path and reason.
cau_status sim_scene_load(const char *source, const char *folder, double unit_m, bool strict,
                          cau_scene_def *scene, cau_error *error);

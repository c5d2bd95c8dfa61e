// SPDX-License-Identifier: GPL-3.0-or-later
// Finds and reads scenes: by name in a folder, from a file, or made around a mesh file.
#pragma once

#include <stdbool.h>

#include "cautery/scene.h"
#include "cautery/status.h"

// Fills *scene from `source`. A file that ends in .json is a scene, and any other file is a mesh,
// with units of unit_m metres (0: guessed); `strict` refuses a mesh that needs mending. Otherwise
// `source` is a scene's name in `folder` (NULL: the installed scenes or, if there are none, those
// of the source tree). Errors name the file, the path and the reason.
cau_status sim_scene_load(const char *source, const char *folder, double unit_m, bool strict,
                          cau_scene_def *scene, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// Finds and reads scenes, makes scenes around mesh files, and makes the script of a scene's cut.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/mesh_scene.h"
#include "cautery/scene.h"
#include "cautery/status.h"

// Fills *scene from `source`. A file that ends in .json is a scene, and any other file is a mesh,
// with units of unit_m metres (0: guessed); `strict` refuses a mesh that needs mending. Otherwise
// `source` is a scene's name in `folder` (NULL: the installed scenes or, if there are none, those
// of the source tree). Errors name the file, the path and the reason.
cau_status sim_scene_load(const char *source, const char *folder, double unit_m, bool strict,
                          cau_scene_def *scene, cau_error *error);

// Calls cau_mesh_scene and adds a cut and a pull to the scene. For the cut, the scene's hot ball
// moves along the middle of the upper side, over 60 % of the longer horizontal extent. The tissue
// is made once to find its surface. The report about the mesh goes to standard error. Errors: those
// of cau_mesh_scene, which name the program's option instead of the member, and those of
// cau_session_create.
cau_status sim_mesh_scene(const cau_mesh_wish *wish, cau_scene_def *scene, cau_error *error);

// Makes the script. The tool comes from its first pose to a point above the tissue. Its energy goes
// on, and it goes down to the start of the cut and dwells. It is drawn to the cut's end, energy
// goes off, and it is lifted. The script has one JSON command on each line; the caller frees *text.
// Errors: CAU_BAD_VALUE (the scene has no cut, or not the cut's tool), CAU_NO_MEMORY.
cau_status sim_cut_script(const cau_scene_def *scene, char **text, size_t *bytes, cau_error *error);

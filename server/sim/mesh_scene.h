// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a scene around any mesh file, with motions that give a first cut and pull.
#pragma once

#include "cautery/mesh_scene.h"

// Calls cau_mesh_scene and adds a cut and a pull to the scene. For the cut, the scene's hot ball
// moves along the middle of the upper side, over 60 % of the longer horizontal extent. The tissue
// is made once to find its surface. The report about the mesh goes to standard error. Errors: those
// of cau_mesh_scene, which name the program's option instead of the member, and those of
// cau_session_create.
cau_status sim_mesh_scene(const cau_mesh_wish *wish, cau_scene_def *scene, cau_error *error);

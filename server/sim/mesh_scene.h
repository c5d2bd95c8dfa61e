// SPDX-License-Identifier: GPL-3.0-or-later
// A scene around any mesh file, with motions: something sensible to look at and to cut.
#pragma once

#include "cautery/mesh_scene.h"

// The scene of cau_mesh_scene, and a cut and a pull. The ball is drawn along the middle of the
// upper side, over 60 % of its longer horizontal extent. The tissue is made once, to learn where
// its surface is. The report of the mesh goes to standard error. Errors: those of cau_mesh_scene,
// in the words of the options, and of cau_session_create.
cau_status sim_mesh_scene(const cau_mesh_wish *wish, cau_scene_def *scene, cau_error *error);

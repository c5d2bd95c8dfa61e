// SPDX-License-Identifier: GPL-3.0-or-later
// A scene around any mesh file: something sensible to look at and to cut.
#pragma once

#include "cautery/scene.h"
#include "cautery/status.h"

// Tetrahedra become fat in its membrane, pinned below; triangles a fascia, pinned at its rim, or
// below where it has none. A hot ball, 3 mm or as large as the mesh's edges, is drawn along the
// middle of the upper side, over 60 % of its longer horizontal extent. No gravity: the shape of a
// scanned organ is its shape under its weight. `unit_m`: metres in one unit of the file. The mesh
// is loaded to learn its elements and extent. Errors: those of cau_session_create.
cau_status sim_mesh_scene(const char *file, double unit_m, cau_scene_def *scene, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// A scene around a mesh file.
#pragma once

#include <stdbool.h>

#include "cautery/client.h"

// Mesh and layers: fat with its membrane, or fascia. The mesh is still a file here. Errors:
// CAU_LIMIT (a name too long).
cau_status cli_mesh_scene_begin(cau_scene_def *scene, const char *file, double unit_m, bool fat,
                                cau_error *error);

// The box around the rest positions, m.
void cli_mesh_scene_measure(const cau_client_stream *stream, double least_m[3], double most_m[3]);

// Pins and tool, from the box.
void cli_mesh_scene_end(cau_scene_def *scene, const double least_m[3], const double most_m[3]);

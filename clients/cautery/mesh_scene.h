// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a scene around a mesh file. The daemon reads the file, reports how it read it, and makes
// the scene.
#pragma once

#include "cautery/cli.h"

// Reads a mesh file. TetGen splits a mesh into two files of one name (.node and .ele or .face);
// both are read, points first. The caller frees *bytes.
cau_status cli_read_mesh_file(const char *file, char **bytes, size_t *byte_count, cau_error *error);

// True if `argument` means a mesh file: an existing file that is not a scene file, or a text that
// cannot be the name of a scene.
bool cli_is_mesh_file(const char *argument);

// Makes the server read the upload `name` of `file` with the options --as, --unit-m and --strict.
// Prints the report and fills *scene with a scene around the mesh. Error texts name these options.
cli_exit cli_mesh_scene(cli *c, const char *file, const char *name, cau_scene_def *scene);

// Makes the server read the upload of `file`, a mesh of a scene file, with the scene's unit and
// strictness. Prints the report.
cli_exit cli_mesh_report(cli *c, const char *file, const cau_mesh_def *mesh);

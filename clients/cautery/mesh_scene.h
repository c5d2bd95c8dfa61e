// SPDX-License-Identifier: GPL-3.0-or-later
// A scene around a mesh file: the daemon reads it, reports what became of it, and makes the scene.
#pragma once

#include "cautery/cli.h"

// Reads a mesh file; of TetGen's two files of one name (.node, .ele or .face) both, points first.
// The caller frees *bytes.
cau_status cli_read_mesh_file(const char *file, char **bytes, size_t *byte_count, cau_error *error);

// Whether `argument` means a mesh file: one that is there and no scene file, or what is no scene's
// name.
bool cli_is_mesh_file(const char *argument);

// Has the upload `name` of `file` read with the options --as, --unit-m and --strict, prints the
// report, and fills *scene with a scene around it. Failures are printed in the words of these
// options.
cli_exit cli_mesh_scene(cli *c, const char *file, const char *name, cau_scene_def *scene);

// Has the upload of `file`, a mesh of a scene file, read with the unit and the strictness that the
// scene says, and prints the report.
cli_exit cli_mesh_report(cli *c, const char *file, const cau_mesh_def *mesh);

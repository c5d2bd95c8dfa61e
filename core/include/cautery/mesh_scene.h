// SPDX-License-Identifier: GPL-3.0-or-later
// A scene around a mesh file: pins, layers, tools and a unit, so that the tissue stands and can be
// grasped and cut.
//
//     #include "cautery/mesh_scene.h"
//
//     // Fills *scene with a scene around `file`, and prints what became of the file.
//     static cau_status open_anatomy(const char *file, cau_scene_def *scene, cau_error *error)
//     {
//         static cau_mesh_report report;
//         char text[CAU_MESH_TEXT_BYTES];
//         cau_mesh_wish wish = {.file = file, .layer_kind = -1};
//         cau_status status = cau_mesh_scene(&wish, scene, &report, error);
//         if (!status) {
//             cau_mesh_report_text(&report, text);
//             fputs(text, stderr);
//         }
//         return status;
//     }
#pragma once

#include <stddef.h>

#include "cautery/mesh_report.h"
#include "cautery/scene.h"
#include "cautery/status.h"

typedef struct cau_mesh_wish {
	const char *file;  // path of a file; with bytes, the name of the upload
	const void *bytes; // NULL: `file` is read
	size_t byte_count;
	double unit_m;      // metres in one unit; 0: guessed where it is clear
	int32_t layer_kind; // CAU_LAYER_FAT or CAU_LAYER_FASCIA; -1: fat where there are tetrahedra
	int32_t strict;     // refuse what would have to be mended
} cau_mesh_wish;

// Reads the mesh and makes a scene around it: its lowest tenth pinned, or the rim of an open sheet;
// a hot ball and a grasper above it; no gravity, as a scanned organ has its shape under its weight
// already. Errors: as for reading; CAU_BAD_MESH at "unit_m" with a proposal where the unit is not
// clear; CAU_BAD_VALUE at "as" where the file lacks the elements of the layer. Threads: any.
cau_status cau_mesh_scene(const cau_mesh_wish *wish, cau_scene_def *scene, cau_mesh_report *report,
                          cau_error *error);

// The report in words, one fact a line.
void cau_mesh_report_text(const cau_mesh_report *report, char bytes[static CAU_MESH_TEXT_BYTES]);

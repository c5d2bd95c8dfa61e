// SPDX-License-Identifier: GPL-3.0-or-later
// Functions that the files of core/tissue share to build a tissue.
#pragma once

#include "tissue/tissue.h"

// Gathers the vertices, triangles and tetrahedra of all layers (layers.c).
cau_status cau_tissue_gather(cau_tissue *tissue, const cau_scene_def *scene, cau_arena *arena,
                             cau_error *error);
// Computes the rest shape of triangles and tetrahedra: D_m^-1, area, volume, mass (rest_shape.c).
cau_status cau_tissue_shape(cau_tissue *tissue, cau_arena *arena, cau_error *error);
// Makes the links between layers (links.c).
cau_status cau_tissue_link(cau_tissue *tissue, cau_arena *arena, cau_error *error);
// Makes the bending hinges (hinges.c); needs the edge table.
cau_status cau_tissue_hinge(cau_tissue *tissue, cau_arena *arena, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// VTK's types of cells, which legacy files and XML files share.
#pragma once

#include "mesh/mesh_builder.h"

enum { CAU_VTK_STRIP = 6, CAU_VTK_POLYGON = 7 };

// Adds a cell of one of VTK's types, or counts it as passed over. Its region is `cell`, its number,
// until the file's regions are known. Fails where it names points that are not there.
void cau_vtk_add_cell(cau_mesh_builder *builder, int64_t type, const int64_t *corner,
                      int64_t corners, int32_t cell);

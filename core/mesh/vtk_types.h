// SPDX-License-Identifier: GPL-3.0-or-later
// VTK's types of cells, for legacy files and XML files.
#pragma once

#include "mesh/mesh_builder.h"

enum { CAU_VTK_STRIP = 6, CAU_VTK_POLYGON = 7 };

// Adds a cell of one of VTK's types, or counts it as skipped. The region of the new elements is
// `cell`, the cell's index, until the regions of the file are known. Fails if the cell has points
// that do not exist.
void cau_vtk_add_cell(cau_mesh_builder *builder, int64_t type, const int64_t *corner,
                      int64_t corners, int32_t cell);

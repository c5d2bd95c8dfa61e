// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/mesh_builder.h"

// Splits the builder's cells into triangles and tetrahedra. Cells that share a quadrangle split it
// in the same way.
void cau_cell_split(cau_mesh_builder *builder);

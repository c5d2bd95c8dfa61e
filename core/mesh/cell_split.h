// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/mesh_builder.h"

// Splits the builder's cells into its triangles and tetrahedra, so that cells that share a
// quadrangle split it alike.
void cau_cell_split(cau_mesh_builder *builder);

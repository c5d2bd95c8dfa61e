// SPDX-License-Identifier: GPL-3.0-or-later
// Gmsh files, versions 1, 2.2 and 4.1, as text and in binary.
#pragma once

#include "mesh/mesh_builder.h"

// Reads builder->scan into the builder's mesh. All failures go to the scan, whose status is
// returned.
cau_status cau_mesh_read_gmsh(cau_mesh_builder *builder);

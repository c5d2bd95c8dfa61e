// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/mesh_builder.h"

// Legacy VTK, text or binary: UNSTRUCTURED_GRID with triangles and tetrahedra, POLYDATA with
// polygons (which become fans); cells as versions up to 5.0 and from 5.1 write them. Regions: the
// cell data of one component called region, material, MaterialIds or CellEntityIds.
cau_status cau_mesh_read_vtk(cau_mesh_builder *builder);

// SPDX-License-Identifier: GPL-3.0-or-later
// The readers of all formats. Each reader reads builder->scan into the builder. All failures go to
// the scan. Each reader returns the scan's status.
#pragma once

#include "mesh/mesh_builder.h"

cau_status cau_mesh_read_gmsh(cau_mesh_builder *builder); // 1, 2.x, 4.0, 4.1; text, binary
cau_status cau_mesh_read_vtk(cau_mesh_builder *builder);  // legacy VTK; text, binary
cau_status cau_mesh_read_vtu(cau_mesh_builder *builder);  // VTU and VTP (XML)
cau_status cau_mesh_read_obj(cau_mesh_builder *builder);  // Wavefront OBJ
cau_status cau_mesh_read_stl(cau_mesh_builder *builder);  // STL; text
cau_status cau_mesh_read_stl_binary(cau_mesh_builder *builder);
cau_status cau_mesh_read_ply(cau_mesh_builder *builder);    // PLY; text, binary
cau_status cau_mesh_read_medit(cau_mesh_builder *builder);  // Medit .mesh
cau_status cau_mesh_read_meshb(cau_mesh_builder *builder);  // Medit .meshb
cau_status cau_mesh_read_tetgen(cau_mesh_builder *builder); // TetGen .node, then .ele or .face
cau_status cau_mesh_read_usda(cau_mesh_builder *builder);   // UsdGeom.TetMesh and Mesh as text

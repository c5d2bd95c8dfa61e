// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/mesh_builder.h"

// Wavefront OBJ: v, vt, f (v, v/vt, v//vn, v/vt/vn; negative numbers count from the last; polygons
// become fans). Texture only where every corner has one. Regions: names of `usemtl` are numbered
// 1, 2, ... as they first appear; those of `g` where the file has no `usemtl`. Other lines are
// passed over.
cau_status cau_mesh_read_obj(cau_mesh_builder *builder);

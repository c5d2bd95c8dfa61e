// SPDX-License-Identifier: GPL-3.0-or-later
// Turns the triangles of a surface so that they face outward.
#pragma once

#include "mesh/mesh.h"

// Turns triangles so that two triangles that alone share an edge have the same orientation. Each
// piece then encloses a positive volume, unless the piece is inside another piece. Such a cavity
// keeps its own orientation. *turned is the number of turned triangles.
cau_status cau_orient(cau_mesh *surface, int32_t *turned, cau_error *error);

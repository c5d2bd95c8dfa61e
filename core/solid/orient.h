// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a surface, turned so that they look outward.
#pragma once

#include "mesh/mesh.h"

// Neighbours over an edge of two triangles come to agree; each piece then encloses a positive
// volume, unless it lies inside another piece (a cavity keeps its own direction). *turned: how many
// triangles were.
cau_status cau_orient(cau_mesh *surface, int32_t *turned, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of primitives before the edge table and the face table are built from them.
#pragma once

#include "mesh/edge_table.h"

// Checks that every index is in [0, vertex_count), that no primitive has a vertex twice, and that
// tables of 32-bit indices can hold all primitives. Errors: CAU_BAD_MESH, which names the
// primitive; CAU_LIMIT.
cau_status cau_primitives_check(const cau_primitives *primitives, cau_error *error);

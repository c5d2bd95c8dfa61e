// SPDX-License-Identifier: GPL-3.0-or-later
// What the edge table and the face table ask of the primitives that they are built from.
#pragma once

#include "mesh/edge_table.h"

// Every index inside [0, vertex_count), no vertex twice in a primitive, and counts small enough for
// tables of 32-bit indices. Errors: CAU_BAD_MESH naming the primitive, CAU_LIMIT.
cau_status cau_primitives_check(const cau_primitives *primitives, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a solid as a file: Gmsh 2.2, binary, with a physical group for each label.
#pragma once

#include "solid/tets.h"

// Writes the file. The region of a tetrahedron is its label's value, or 1 without labels. The
// caller frees *bytes.
cau_status cau_gmsh_write(const cau_tets *tets, const cau_volume *volume, unsigned char **bytes,
                          size_t *byte_count, cau_error *error);

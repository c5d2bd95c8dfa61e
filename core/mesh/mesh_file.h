// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stddef.h>

#include "cautery/status.h"

// Reads the whole of a regular file of at most 1 GiB. TetGen's two files of one name (.node, .ele
// or .face) are read together, whichever is named: points first, then elements. The caller frees
// *bytes. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY.
cau_status cau_mesh_file_load(const char *path, void **bytes, size_t *byte_count, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stddef.h>

#include "cautery/status.h"

// Reads a whole regular file of at most 1 GiB. A TetGen mesh has two files of one name (.node, and
// .ele or .face). `path` may name either file, and both are read: points first, then elements. The
// caller frees *bytes. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY.
cau_status cau_mesh_file_load(const char *path, void **bytes, size_t *byte_count, cau_error *error);

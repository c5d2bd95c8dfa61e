// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a whole file into memory.
#pragma once

#include <stddef.h>

#include "cautery/status.h"

// Reads a regular file of at most `most` bytes. The caller frees *text, which ends with a zero
// byte. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY; error->file is `path`.
cau_status embed_read_file(const char *path, size_t most, char **text, size_t *bytes,
                           cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// Files on this machine, whole. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY; error->file names it.
#pragma once

#include <stddef.h>

#include "cautery/status.h"

// "-" reads standard input. Adds a zero after the last byte. The caller frees *bytes.
cau_status cli_read_file(const char *name, size_t bytes_max, char **bytes, size_t *byte_count,
                         cau_error *error);

// "-" writes standard output. What could not be written whole is removed.
cau_status cli_write_file(const char *name, const void *bytes, size_t byte_count, cau_error *error);

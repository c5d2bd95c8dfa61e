// SPDX-License-Identifier: GPL-3.0-or-later
// Reads and writes whole local files. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY; error->file names
// the file.
#pragma once

#include <stddef.h>

#include "cautery/status.h"

// Reads a file and adds a zero after the last byte. The name "-" means standard input. The caller
// frees *bytes.
cau_status cli_read_file(const char *name, size_t bytes_max, char **bytes, size_t *byte_count,
                         cau_error *error);

// Writes a file. The name "-" means standard output. An incomplete file is removed.
cau_status cli_write_file(const char *name, const void *bytes, size_t byte_count, cau_error *error);

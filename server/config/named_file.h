// SPDX-License-Identifier: GPL-3.0-or-later
// Opens files that a setting names: tokens, certificate and key, roles, settings, scenes. They are
// read at the start and at a signal, by a thread that must not block. So only regular files of
// bounded size are opened: a FIFO would wait for a writer, and a device may never end.
#pragma once

#include <stdint.h>
#include <stdio.h>
#include <sys/stat.h>

enum {
	CAU_NAMED_FILE_REASON_BYTES = 96,
	CAU_NAMED_FILE_BYTES =
		1 << 20, // limit for tokens, keys and roles, far more than such files need
};

// Opens a regular file of at most `most_bytes` for reading. `info` may be NULL. On failure returns
// NULL; `reason` then is the end of "cannot read FILE: ...".
FILE *cau_named_file_open(const char *path, int64_t most_bytes, struct stat *info,
                          char reason[CAU_NAMED_FILE_REASON_BYTES]);

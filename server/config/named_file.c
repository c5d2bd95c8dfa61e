// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/named_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>

static bool is_readable(int descriptor, int64_t most_bytes, struct stat *info,
                        char reason[CAU_NAMED_FILE_REASON_BYTES])
{
	const char *what = NULL;
	if (fstat(descriptor, info))
		what = strerrordesc_np(errno);
	else if (S_ISDIR(info->st_mode))
		what = "this is a folder, not a file";
	else if (!S_ISREG(info->st_mode))
		what = "this is not a regular file";
	if (what)
		snprintf(reason, CAU_NAMED_FILE_REASON_BYTES, "%s", what);
	else if (info->st_size > most_bytes)
		snprintf(reason, CAU_NAMED_FILE_REASON_BYTES, "the file is longer than %lld bytes",
		         (long long)most_bytes);
	return !what && info->st_size <= most_bytes;
}

FILE *cau_named_file_open(const char *path, int64_t most_bytes, struct stat *info,
                          char reason[CAU_NAMED_FILE_REASON_BYTES])
{
	struct stat own;
	// Without O_NONBLOCK, opening a FIFO would wait for a writer.
	int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	if (descriptor < 0) {
		snprintf(reason, CAU_NAMED_FILE_REASON_BYTES, "%s", strerrordesc_np(errno));
		return NULL;
	}
	FILE *stream = NULL;
	if (is_readable(descriptor, most_bytes, info ? info : &own, reason)) {
		stream = fdopen(descriptor, "r");
		if (!stream)
			snprintf(reason, CAU_NAMED_FILE_REASON_BYTES, "%s", strerrordesc_np(errno));
	}
	if (!stream)
		close(descriptor);
	return stream;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "embed/whole_file.h"

#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static cau_status fail_file(const char *doing, cau_error *error)
{
	return cau_fail(error, CAU_IO, NULL, "cannot %s: %s", doing, strerror(errno));
}

static cau_status check_size(const struct stat *info, size_t most, cau_error *error)
{
	if (!S_ISREG(info->st_mode)) {
		errno = S_ISDIR(info->st_mode) ? EISDIR : EINVAL;
		return fail_file("read", error);
	}
	if ((uint64_t)info->st_size > most)
		return cau_fail(error, CAU_LIMIT, NULL, "the file has %lld bytes, the limit is %zu",
		                (long long)info->st_size, most);
	return CAU_OK;
}

// Reads at most `capacity` bytes and adds a zero behind them.
static cau_status read_all(FILE *file, size_t capacity, char **text, size_t *bytes,
                           cau_error *error)
{
	char *made = malloc(capacity + 1);
	if (!made)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %zu bytes", capacity);
	*bytes = fread(made, 1, capacity, file);
	if (ferror(file)) {
		cau_status status = fail_file("read", error);
		free(made);
		return status;
	}
	made[*bytes] = 0;
	*text = made;
	return CAU_OK;
}

cau_status embed_read_file(const char *path, size_t most, char **text, size_t *bytes,
                           cau_error *error)
{
	struct stat info;
	*text = NULL;
	*bytes = 0;
	if (error)
		snprintf(error->file, sizeof error->file, "%.255s", path);
	FILE *file = fopen(path, "rb");
	if (!file)
		return fail_file("open", error);
	cau_status status =
		fstat(fileno(file), &info) ? fail_file("read", error) : check_size(&info, most, error);
	if (!status)
		status = read_all(file, (size_t)info.st_size, text, bytes, error);
	fclose(file);
	return status;
}

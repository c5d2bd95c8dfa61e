// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/local_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 65536 };

static cau_status fail(const char *name, cau_status status, const char *reason, cau_error *error)
{
	snprintf(error->file, sizeof error->file, "%.255s", strcmp(name, "-") == 0 ? "-" : name);
	return cau_fail(error, status, NULL, "%s", reason);
}

static cau_status read_all(FILE *file, const char *name, size_t bytes_max, char **bytes,
                           size_t *byte_count, cau_error *error)
{
	for (size_t capacity = FIRST_CAPACITY;; capacity *= 2) {
		char *grown = realloc(*bytes, capacity);
		if (!grown)
			return fail(name, CAU_NO_MEMORY, "no memory to read the file", error);
		*bytes = grown;
		*byte_count += fread(grown + *byte_count, 1, capacity - 1 - *byte_count, file);
		if (ferror(file))
			return fail(name, CAU_IO, strerror(errno), error);
		if (*byte_count > bytes_max)
			return fail(name, CAU_LIMIT, "the file is too large", error);
		if (*byte_count < capacity - 1) {
			grown[*byte_count] = 0;
			return CAU_OK;
		}
	}
}

cau_status cli_read_file(const char *name, size_t bytes_max, char **bytes, size_t *byte_count,
                         cau_error *error)
{
	int from_input = strcmp(name, "-") == 0;
	FILE *file = from_input ? stdin : fopen(name, "rb");
	*bytes = NULL;
	*byte_count = 0;
	if (!file)
		return fail(name, CAU_IO, strerror(errno), error);
	cau_status status = read_all(file, name, bytes_max, bytes, byte_count, error);
	if (!from_input)
		fclose(file);
	if (status) {
		free(*bytes);
		*bytes = NULL;
	}
	return status;
}

cau_status cli_write_file(const char *name, const void *bytes, size_t byte_count, cau_error *error)
{
	if (strcmp(name, "-") == 0)
		return fwrite(bytes, 1, byte_count, stdout) == byte_count && fflush(stdout) == 0
		           ? CAU_OK
		           : fail(name, CAU_IO, strerror(errno), error);
	FILE *file = fopen(name, "wb");
	if (!file)
		return fail(name, CAU_IO, strerror(errno), error);
	size_t written = fwrite(bytes, 1, byte_count, file);
	int trouble = written == byte_count ? 0 : errno;
	if (fclose(file) && !trouble)
		trouble = errno;
	if (!trouble)
		return CAU_OK;
	remove(name);
	return fail(name, CAU_IO, strerror(trouble), error);
}

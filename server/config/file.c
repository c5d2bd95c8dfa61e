// SPDX-License-Identifier: GPL-3.0-or-later
// Opens files that settings name, and reads a settings file.
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cautery/json_text.h"
#include "config/config.h"
#include "config/setting.h"

// ---- files that a setting names
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

// ---- the settings file
// A settings file is one flat JSON object. A strict scan checks its form first, so the functions
// below only have to cut it into names and values.

enum { FILE_MAX_BYTES = 65536 };

static cau_status read_whole(const char *file, char *text, size_t *bytes, cau_error *error)
{
	char reason[CAU_NAMED_FILE_REASON_BYTES];
	FILE *stream = cau_named_file_open(file, FILE_MAX_BYTES, NULL, reason);
	if (!stream)
		return cau_fail(error, CAU_IO, "config", "cannot open %.200s: %s", file, reason);
	*bytes = fread(text, 1, FILE_MAX_BYTES + 1, stream);
	bool failed = ferror(stream);
	fclose(stream);
	if (failed)
		return cau_fail(error, CAU_IO, "config", "cannot read %.200s", file);
	if (*bytes > FILE_MAX_BYTES)
		return cau_fail(error, CAU_LIMIT, "config", "longer than %d bytes", FILE_MAX_BYTES);
	text[*bytes] = 0;
	return CAU_OK;
}

static const char *skip_space(const char *at)
{
	return at + strspn(at, " \t\r\n");
}

// Copies a string's content. Returns false if the string is too long or has an escape other than
// \", \\ and \/.
static bool take_string(const char **at, char *text, size_t capacity)
{
	size_t length = 0;
	const char *c = *at + 1;
	for (; *c != '"'; c++) {
		if (*c == '\\' && *++c != '"' && *c != '\\' && *c != '/')
			return false;
		if (length + 1 >= capacity)
			return false;
		text[length++] = *c;
	}
	text[length] = 0;
	*at = c + 1;
	return true;
}

// Copies a number, true or false. Returns false for an object or an array.
static bool take_plain(const char **at, char *text, size_t capacity)
{
	size_t length = strcspn(*at, ",} \t\r\n");
	if (**at == '{' || **at == '[' || length >= capacity)
		return false;
	memcpy(text, *at, length);
	text[length] = 0;
	*at += length;
	return true;
}

static cau_status store_member(cau_config *config, const char *name, const char *text, bool quoted,
                               cau_error *error)
{
	const setting *found = cau_setting_find(name);
	if (!found || strchr(name, '-'))
		return cau_fail(error, CAU_NOT_FOUND, name, "there is no such setting");
	if (quoted != (found->kind == SETTING_TEXT))
		return cau_fail(error, CAU_BAD_VALUE, name,
		                quoted ? "must not be a string" : "must be a string");
	return cau_setting_store(found, config, text, error);
}

static cau_status read_members(cau_config *config, const char *at, cau_error *error)
{
	char name[64], text[CAU_CONFIG_TEXT_BYTES];
	at = skip_space(at);
	if (*at != '{')
		return cau_fail(error, CAU_BAD_VALUE, "", "the file must contain a JSON object");
	at = skip_space(at + 1);
	while (*at != '}') {
		if (!take_string(&at, name, sizeof name))
			return cau_fail(
				error, CAU_NOT_FOUND, "",
				"a name is longer than %zu bytes or has an escape other than \\\", \\\\ "
				"and \\/, so it is no setting",
				sizeof name - 1);
		at = skip_space(skip_space(at) + 1); // past the colon
		bool quoted = *at == '"';
		if (!(quoted ? take_string(&at, text, sizeof text) : take_plain(&at, text, sizeof text)))
			return *at == '{' || *at == '['
			           ? cau_fail(error, CAU_BAD_VALUE, name, "must not be an object or an array")
			           : cau_fail(error, CAU_BAD_VALUE, name,
			                      "is longer than %zu bytes or has an escape other than \\\", \\\\ "
			                      "and \\/",
			                      sizeof text - 1);
		cau_status status = store_member(config, name, text, quoted, error);
		if (status)
			return status;
		at = skip_space(at);
		if (*at == ',')
			at = skip_space(at + 1);
	}
	return CAU_OK;
}

cau_status cau_config_read_text(cau_config *config, const char *text, size_t bytes,
                                cau_error *error)
{
	cau_status status = cau_json_scan(text, bytes, FILE_MAX_BYTES, error);
	return status ? status : read_members(config, text, error);
}

cau_status cau_config_read_file(cau_config *config, const char *file, cau_error *error)
{
	size_t bytes = 0;
	char *text = malloc(FILE_MAX_BYTES + 2);
	if (!text)
		return cau_fail(error, CAU_NO_MEMORY, "config", "memory ran out");
	cau_status status = read_whole(file, text, &bytes, error);
	if (!status)
		status = cau_config_read_text(config, text, bytes, error);
	if (status && error)
		snprintf(error->file, sizeof error->file, "%.250s", file);
	free(text);
	return status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Local files: reads and writes whole files, and the file of the contexts.
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cautery/cli.h"

// ---- whole files -------------------------------------------------------------------------------
enum { FIRST_CAPACITY = 65536 };

static cau_status fail(const char *name, cau_status status, const char *reason, cau_error *error)
{
	snprintf(error->file, sizeof error->file, "%.255s", strcmp(name, "-") == 0 ? "-" : name);
	return cau_fail(error, status, NULL, "%s", reason);
}

static cau_status fail_as_too_long(const char *name, size_t bytes_max, cau_error *error)
{
	char reason[64];
	snprintf(reason, sizeof reason, "the file is longer than %zu bytes", bytes_max);
	return fail(name, CAU_LIMIT, reason, error);
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
			return fail_as_too_long(name, bytes_max, error);
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

// ---- contexts ----------------------------------------------------------------------------------
enum { FILE_BYTES_MAX = 1 << 20 };

// True if there is a folder for contexts. A service or a cron job may have neither XDG_CONFIG_HOME
// nor HOME. Then there are no contexts.
static bool has_folder(void)
{
	const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
	return (config && config[0] == '/') || (home && *home);
}

static cau_status find_folder(char *folder, size_t bytes, cau_error *error)
{
	const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
	// By the XDG specification, a relative path is ignored.
	bool set = config && config[0] == '/';
	if (!has_folder())
		return cau_fail(error, CAU_IO, NULL, "neither XDG_CONFIG_HOME nor HOME is set");
	int length =
		snprintf(folder, bytes, "%s%s/cautery", set ? config : home, set ? "" : "/.config");
	if (length < 0 || (size_t)length >= bytes)
		return cau_fail(error, CAU_LIMIT, NULL,
		                "the path of the folder of the contexts is longer than %zu bytes: set "
		                "XDG_CONFIG_HOME to a shorter one",
		                bytes - 1);
	return CAU_OK;
}

static cau_status find_file(char *file, size_t bytes, cau_error *error)
{
	char folder[CLI_CONTEXT_TEXT_BYTES];
	cau_status status = find_folder(folder, sizeof folder, error);
	if (!status)
		snprintf(file, bytes, "%s/contexts.json", folder);
	return status;
}

static cJSON *no_contexts(void)
{
	cJSON *all = cJSON_CreateObject();
	if (!cJSON_AddObjectToObject(all, "contexts")) {
		cJSON_Delete(all);
		return NULL;
	}
	return all;
}

cau_status cli_contexts_read(cJSON **all, cau_error *error)
{
	char file[CLI_CONTEXT_TEXT_BYTES + 32], *text = NULL;
	size_t bytes;
	*all = NULL;
	if (!has_folder()) {
		*all = no_contexts();
		return *all ? CAU_OK : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the contexts");
	}
	cau_status status = find_file(file, sizeof file, error);
	if (status)
		return status;
	if (access(file, F_OK) != 0 && errno == ENOENT)
		*all = no_contexts();
	else if ((status = cli_read_file(file, FILE_BYTES_MAX, &text, &bytes, error)))
		return status;
	else
		*all = cJSON_ParseWithLength(text, bytes);
	free(text);
	if (cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(*all, "contexts")))
		return CAU_OK;
	cJSON_Delete(*all);
	*all = NULL;
	snprintf(error->file, sizeof error->file, "%.255s", file);
	return cau_fail(error, CAU_BAD_SYNTAX, NULL,
	                "the file is not a list of contexts: repair or remove it");
}

cau_status cli_contexts_write(const cJSON *all, cau_error *error)
{
	char folder[CLI_CONTEXT_TEXT_BYTES], file[sizeof folder + 32], made[sizeof file + 8];
	cau_status status = find_folder(folder, sizeof folder, error);
	if (status)
		return status;
	snprintf(file, sizeof file, "%s/contexts.json", folder);
	snprintf(made, sizeof made, "%s.new", file);
	char *text = cJSON_Print(all);
	if (!text)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the contexts");
	for (char *slash = strchr(folder + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = 0;
		mkdir(folder, 0700);
		*slash = '/';
	}
	mkdir(folder, 0700);
	mode_t before = umask(0077);
	status = cli_write_file(made, text, strlen(text), error);
	umask(before);
	free(text);
	if (!status && rename(made, file) != 0) {
		snprintf(error->file, sizeof error->file, "%.255s", file);
		status = cau_fail(error, CAU_IO, NULL, "%s", strerror(errno));
	}
	return status;
}

const char *cli_context_text(const cJSON *object, const char *member)
{
	const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, member));
	return text ? text : "";
}

cJSON *cli_contexts_of(const cJSON *all)
{
	return cJSON_GetObjectItemCaseSensitive(all, "contexts");
}

cau_status cli_context_find(const char *name, cli_context *context, cau_error *error)
{
	cJSON *all;
	*context = (cli_context){0};
	cau_status status = cli_contexts_read(&all, error);
	if (status)
		return status;
	const char *wanted = name ? name : cli_context_text(all, "current");
	const cJSON *found = cJSON_GetObjectItemCaseSensitive(cli_contexts_of(all), wanted);
	if (found) {
		snprintf(context->url, sizeof context->url, "%s", cli_context_text(found, "url"));
		snprintf(context->token_file, sizeof context->token_file, "%s",
		         cli_context_text(found, "token_file"));
	} else if (*wanted) {
		status = cau_fail(error, CAU_NOT_FOUND, NULL,
		                  "no context \"%s\"; `cautery context ls` lists them", wanted);
	}
	cJSON_Delete(all);
	return status;
}

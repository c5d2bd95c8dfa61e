// SPDX-License-Identifier: GPL-3.0-or-later
// context: daemons by name.
#include "cautery/contexts.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include "cautery/commands.h"
#include "cautery/local_file.h"
#include "cautery/name.h"

enum { FILE_BYTES_MAX = 1 << 20 };

// ---- the file -----------------------------------------------------------------------------------
static cau_status find_folder(char *folder, size_t bytes, cau_error *error)
{
	const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
	bool set = config && config[0] == '/'; // a relative one is to be ignored (XDG)
	if (!set && !(home && *home))
		return cau_fail(error, CAU_IO, NULL, "neither XDG_CONFIG_HOME nor HOME says where it is");
	int length =
		snprintf(folder, bytes, "%s%s/cautery", set ? config : home, set ? "" : "/.config");
	if (length < 0 || (size_t)length >= bytes)
		return cau_fail(error, CAU_LIMIT, NULL, "the name of its folder is too long");
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

// To be deleted. A file that is not there holds nothing.
static cau_status read_contexts(cJSON **all, cau_error *error)
{
	char file[CLI_CONTEXT_TEXT_BYTES + 32], *text = NULL;
	size_t bytes;
	*all = NULL;
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
	return cau_fail(error, CAU_BAD_SYNTAX, NULL, "it holds no contexts: mend it or remove it");
}

// Into its place only when it is whole.
static cau_status write_contexts(const cJSON *all, cau_error *error)
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

static const char *text_of(const cJSON *object, const char *member)
{
	const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, member));
	return text ? text : "";
}

static cJSON *contexts_of(const cJSON *all)
{
	return cJSON_GetObjectItemCaseSensitive(all, "contexts");
}

cau_status cli_context_find(const char *name, cli_context *context, cau_error *error)
{
	cJSON *all;
	*context = (cli_context){0};
	cau_status status = read_contexts(&all, error);
	if (status)
		return status;
	const char *wanted = name ? name : text_of(all, "current");
	const cJSON *found = cJSON_GetObjectItemCaseSensitive(contexts_of(all), wanted);
	if (found) {
		snprintf(context->url, sizeof context->url, "%s", text_of(found, "url"));
		snprintf(context->token_file, sizeof context->token_file, "%s",
		         text_of(found, "token_file"));
	} else if (*wanted) {
		status = cau_fail(error, CAU_NOT_FOUND, NULL,
		                  "no context \"%s\"; `cautery context ls` lists them", wanted);
	}
	cJSON_Delete(all);
	return status;
}

// ---- the commands -------------------------------------------------------------------------------
static cli_exit run_ls(cli *c)
{
	cJSON *all;
	if (read_contexts(&all, &c->error))
		return cli_fail_file(c);
	char *text = c->json ? cJSON_PrintUnformatted(all) : NULL;
	if (text)
		fprintf(c->out, "%s\n", text);
	free(text);
	const char *current = text_of(all, "current");
	for (const cJSON *m = contexts_of(all)->child; m && !c->json; m = m->next) {
		const char *token_file = text_of(m, "token_file");
		fprintf(c->out, "%c %-16s %s%s%s\n", strcmp(m->string, current) == 0 ? '*' : ' ', m->string,
		        text_of(m, "url"), *token_file ? ", token in " : "", token_file);
	}
	cJSON_Delete(all);
	return CLI_DONE;
}

static bool fill_context(cJSON *context, const cli *c)
{
	char *file = c->token_file ? realpath(c->token_file, NULL) : NULL;
	const char *token_file = file ? file : c->token_file;
	bool made = cJSON_AddStringToObject(context, "url", c->url ? c->url : CAU_CLIENT_DEFAULT_URL) &&
	            (!token_file || cJSON_AddStringToObject(context, "token_file", token_file));
	free(file);
	return made;
}

// The file as `change` makes it. It tells what is wrong by itself.
static cli_exit change_contexts(cli *c, cli_exit (*change)(cli *c, cJSON *all))
{
	cJSON *all;
	if (read_contexts(&all, &c->error))
		return cli_fail_file(c);
	cli_exit code = change(c, all);
	if (!code && write_contexts(all, &c->error))
		code = cli_fail_file(c);
	cJSON_Delete(all);
	return code;
}

static bool use(cJSON *all, const char *name)
{
	cJSON_DeleteItemFromObjectCaseSensitive(all, "current");
	return cJSON_AddStringToObject(all, "current", name);
}

// The first one is the current one.
static cli_exit set(cli *c, cJSON *all)
{
	const char *name = c->arguments[0];
	bool first = !contexts_of(all)->child;
	if (!cau_name_is_valid(name)) {
		cli_complain(c, "\"%s\" is no name: %s", name, CAU_NAME_RULE);
		return CLI_USAGE;
	}
	cJSON_DeleteItemFromObjectCaseSensitive(contexts_of(all), name);
	cJSON *made = cJSON_AddObjectToObject(contexts_of(all), name);
	if (made && fill_context(made, c) && (!first || use(all, name)))
		return CLI_DONE;
	cau_fail(&c->error, CAU_NO_MEMORY, NULL, "no memory for the contexts");
	return cli_fail_file(c);
}

static bool is_there(const cli *c, const cJSON *all)
{
	enum { MOST = 256 };
	const char *names[MOST];
	size_t count = 0;
	if (cJSON_GetObjectItemCaseSensitive(contexts_of(all), c->arguments[0]))
		return true;
	for (const cJSON *m = contexts_of(all)->child; m && count < MOST; m = m->next)
		names[count++] = m->string;
	cli_complain_unknown(c, "context", c->arguments[0], names, count);
	return false;
}

static cli_exit choose(cli *c, cJSON *all)
{
	if (!is_there(c, all))
		return CLI_USAGE;
	if (use(all, c->arguments[0]))
		return CLI_DONE;
	cau_fail(&c->error, CAU_NO_MEMORY, NULL, "no memory for the contexts");
	return cli_fail_file(c);
}

static cli_exit take_out(cli *c, cJSON *all)
{
	if (!is_there(c, all))
		return CLI_USAGE;
	if (strcmp(text_of(all, "current"), c->arguments[0]) == 0)
		cJSON_DeleteItemFromObjectCaseSensitive(all, "current");
	cJSON_DeleteItemFromObjectCaseSensitive(contexts_of(all), c->arguments[0]);
	return CLI_DONE;
}

static cli_exit run_set(cli *c)
{
	return change_contexts(c, set);
}

static cli_exit run_use(cli *c)
{
	return change_contexts(c, choose);
}

static cli_exit run_rm(cli *c)
{
	return change_contexts(c, take_out);
}

const cli_command cli_context_ls = {.name = "context ls",
                                    .also = "context",
                                    .arguments = "",
                                    .summary = "lists daemons that have a name here",
                                    .help = "The current one, marked by *, is the default of --url "
                                            "and --token-file.\n",
                                    .run = run_ls};

const cli_command cli_context_set = {
	.name = "context set",
	.arguments = "NAME",
	.summary = "gives the daemon at --url a name, with --token-file for it",
	.least = 1,
	.most = 1,
	.run = run_set};

const cli_command cli_context_use = {.name = "context use",
                                     .arguments = "NAME",
                                     .summary = "makes a context the current one",
                                     .least = 1,
                                     .most = 1,
                                     .run = run_use};

const cli_command cli_context_rm = {.name = "context rm",
                                    .arguments = "NAME",
                                    .summary = "forgets a context",
                                    .least = 1,
                                    .most = 1,
                                    .run = run_rm};

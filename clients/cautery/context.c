// SPDX-License-Identifier: GPL-3.0-or-later
// The command `context`: manages the named daemons of cli.h.
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"
#include "cautery/name.h"

static cli_exit run_ls(cli *c)
{
	cJSON *all;
	if (cli_contexts_read(&all, &c->error))
		return cli_fail_file(c);
	char *text = c->json ? cJSON_PrintUnformatted(all) : NULL;
	if (text)
		fprintf(c->out, "%s\n", text);
	free(text);
	const char *current = cli_context_text(all, "current");
	for (const cJSON *m = cli_contexts_of(all)->child; m && !c->json; m = m->next) {
		const char *token_file = cli_context_text(m, "token_file");
		fprintf(c->out, "%c %-16s %s%s%s\n", strcmp(m->string, current) == 0 ? '*' : ' ', m->string,
		        cli_context_text(m, "url"), *token_file ? ", token in " : "", token_file);
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

// Reads the contexts, lets `change` edit them, and writes them back. `change` prints its own
// errors.
static cli_exit change_contexts(cli *c, cli_exit (*change)(cli *c, cJSON *all))
{
	cJSON *all;
	if (cli_contexts_read(&all, &c->error))
		return cli_fail_file(c);
	cli_exit code = change(c, all);
	if (!code && cli_contexts_write(all, &c->error))
		code = cli_fail_file(c);
	cJSON_Delete(all);
	return code;
}

static bool use(cJSON *all, const char *name)
{
	cJSON_DeleteItemFromObjectCaseSensitive(all, "current");
	return cJSON_AddStringToObject(all, "current", name);
}

// Adds or replaces a context. The first context also becomes the current one.
static cli_exit set(cli *c, cJSON *all)
{
	const char *name = c->arguments[0];
	bool first = !cli_contexts_of(all)->child;
	if (!cau_name_is_valid(name)) {
		cli_complain(c, "\"%s\" is not a valid name: %s", name, CAU_NAME_RULE);
		return CLI_USAGE;
	}
	cJSON_DeleteItemFromObjectCaseSensitive(cli_contexts_of(all), name);
	cJSON *made = cJSON_AddObjectToObject(cli_contexts_of(all), name);
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
	if (cJSON_GetObjectItemCaseSensitive(cli_contexts_of(all), c->arguments[0]))
		return true;
	for (const cJSON *m = cli_contexts_of(all)->child; m && count < MOST; m = m->next)
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
	if (strcmp(cli_context_text(all, "current"), c->arguments[0]) == 0)
		cJSON_DeleteItemFromObjectCaseSensitive(all, "current");
	cJSON_DeleteItemFromObjectCaseSensitive(cli_contexts_of(all), c->arguments[0]);
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

const cli_command cli_context_ls = {
	.name = "context ls",
	.also = "context",
	.arguments = "",
	.summary = "lists the contexts: daemons to which this command has given a name",
	.help = "The current context, marked by *, is the default of --url "
			"and --token-file.\n",
	.run = run_ls};

const cli_command cli_context_set = {
	.name = "context set",
	.arguments = "NAME",
	.summary = "names the daemon at --url as a context, with its --token-file",
	.least = 1,
	.most = 1,
	.run = run_set};

const cli_command cli_context_use = {.name = "context use",
                                     .arguments = "NAME",
                                     .summary = "makes a context the current context",
                                     .least = 1,
                                     .most = 1,
                                     .run = run_use};

const cli_command cli_context_rm = {.name = "context rm",
                                    .arguments = "NAME",
                                    .summary = "removes a context",
                                    .least = 1,
                                    .most = 1,
                                    .run = run_rm};

// SPDX-License-Identifier: GPL-3.0-or-later
// The command line.
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"

static const cli_option common[] = {
	{"url", "U", "where the daemon is (default: CAUTERYD_URL, else " CAU_CLIENT_DEFAULT_URL ")"},
	{"token", "T", "access token (default: CAUTERYD_TOKEN)"},
	{"timeout", "S", "seconds to wait for an answer (default 30)"},
	{"json", NULL, "one JSON object a line on standard output, the last one the result"},
	{"help", NULL, "this text"},
	{0},
};

// ---- help --------------------------------------------------------------------------------------
static void print_options(FILE *out, const cli_option *options, int count)
{
	for (int i = 0; i < count && options[i].name; i++) {
		char left[40];
		snprintf(left, sizeof left, "--%s %s", options[i].name,
		         options[i].argument ? options[i].argument : "");
		fprintf(out, "  %-18s %s\n", left, options[i].meaning);
	}
}

static void help_of_command(const cli *c)
{
	fprintf(c->out, "cautery %s %s\n%s\n", c->command->name, c->command->arguments,
	        c->command->summary);
	if (c->command->help)
		fprintf(c->out, "\n%s", c->command->help);
	fputc('\n', c->out);
	print_options(c->out, c->command->options, CLI_OPTIONS_MAX);
	print_options(c->out, common, sizeof common / sizeof *common);
}

void cli_help(const cli *c)
{
	if (c->command) {
		help_of_command(c);
		return;
	}
	fputs("cautery COMMAND [arguments]\nTalks to a cauteryd.\n\n", c->out);
	for (int i = 0; cli_commands[i]; i++)
		fprintf(c->out, "  %-9s %s\n", cli_commands[i]->name, cli_commands[i]->summary);
	fputs("\nWhere SESSION may be left out, it is the only one that the daemon has.\n"
	      "`cautery COMMAND --help` says more. All commands take:\n\n",
	      c->out);
	print_options(c->out, common, sizeof common / sizeof *common);
	fputs("\nExit code: 0 done; 1 the server refused, or the session is faulted or gone;\n"
	      "2 arguments; 3 no server, no answer or connection lost; 4 a file here;\n"
	      "5 a script was refused in part, lost its energy, or was interrupted.\n",
	      c->out);
}

// ---- reading -----------------------------------------------------------------------------------
static bool take_common(cli *c, int index, const char *value)
{
	switch (index) {
	case 0:
		c->url = value;
		return true;
	case 1:
		c->token = value;
		return true;
	case 2:
		return cli_read_number(c, "--timeout", value, 0.01, 86400, &c->timeout_s);
	case 3:
		return c->json = true;
	default:
		return c->help = true;
	}
}

// Finds `name` (of `bytes`) in a table; -1: not there.
static int find_option(const cli_option *options, int count, const char *name, size_t bytes)
{
	for (int i = 0; i < count && options[i].name; i++)
		if (strlen(options[i].name) == bytes && strncmp(options[i].name, name, bytes) == 0)
			return i;
	return -1;
}

// Reads the option at arguments[*at], moving *at on over its value.
static bool read_option(cli *c, char **arguments, int count, int *at)
{
	const char *name = arguments[*at] + 2;
	size_t bytes = strcspn(name, "=");
	int own = c->command ? find_option(c->command->options, CLI_OPTIONS_MAX, name, bytes) : -1;
	int shared = find_option(common, sizeof common / sizeof *common, name, bytes);
	if (own < 0 && shared < 0) {
		cli_complain(c, "no option --%.*s; --help lists them", (int)bytes, name);
		return false;
	}
	const cli_option *option = own >= 0 ? &c->command->options[own] : &common[shared];
	const char *value = name[bytes] ? name + bytes + 1 : NULL;
	if (option->argument && !value && *at + 1 < count)
		value = arguments[++*at];
	if (!option->argument != !value) {
		cli_complain(c, option->argument ? "--%s wants a value" : "--%s takes no value",
		             option->name);
		return false;
	}
	if (own < 0)
		return take_common(c, shared, value);
	c->values[own] = value ? value : "";
	return true;
}

static bool take_word(cli *c, const char *word)
{
	if (!c->command) {
		c->command = cli_find_command(word);
		if (!c->command)
			cli_complain(c, "no command \"%s\"; --help lists them", word);
		return c->command;
	}
	if (c->argument_count == CLI_ARGUMENTS_MAX) {
		cli_complain(c, "more than %d arguments", CLI_ARGUMENTS_MAX);
		return false;
	}
	c->arguments[c->argument_count++] = word;
	return true;
}

bool cli_read(cli *c, int argument_count, char **arguments)
{
	bool words_only = false;
	c->timeout_s = 30;
	c->url = getenv("CAUTERYD_URL");
	c->token = getenv("CAUTERYD_TOKEN");
	for (int i = 1; i < argument_count; i++) {
		if (!words_only && strcmp(arguments[i], "--") == 0)
			words_only = true;
		else if (!words_only && strncmp(arguments[i], "--", 2) == 0) {
			if (!read_option(c, arguments, argument_count, &i))
				return false;
		} else if (!take_word(c, arguments[i])) {
			return false;
		}
	}
	if (c->help)
		return true;
	if (!c->command) {
		cli_complain(c, "which command? --help lists them");
		return false;
	}
	int most = c->command->most + c->command->session_optional;
	if (c->argument_count < c->command->least || c->argument_count > most) {
		cli_complain(c, "the arguments are: %s", c->command->arguments);
		return false;
	}
	return true;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the command line and prints help.
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"

static const cli_option common[] = {
	{"url", "U",
     "address of the daemon (default: CAUTERYD_URL, the context, " CAU_CLIENT_DEFAULT_URL ")"},
	{"token-file", "F", "file with the access token (default: the context's, CAUTERYD_TOKEN)"},
	{"context", "NAME",
     "name of a context, as `cautery context ls` lists (default: the current one)"},
	{"label", "L", "label of the daemon behind a proxy; ls takes several, as in d1,d2"},
	{"timeout", "S", "seconds to wait for an answer or a progress report (default 30)"},
	{"json", NULL, "print one JSON object in each line; the last is the result"},
	{"help", NULL, "print this text; -h does the same"},
	{"version", NULL, "print the version of this program and of its protocol"},
	{0},
};

enum { COMMON_COUNT = sizeof common / sizeof *common, OPTION_BYTES = 40 };

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
	if (c->command->also)
		fprintf(c->out, "(`cautery %s` is the same.)\n", c->command->also);
	if (c->command->help)
		fprintf(c->out, "\n%s", c->command->help);
	fputc('\n', c->out);
	print_options(c->out, c->command->options, CLI_OPTIONS_MAX);
	print_options(c->out, common, COMMON_COUNT);
}

void cli_help(const cli *c)
{
	if (c->command) {
		help_of_command(c);
		return;
	}
	fputs("cautery COMMAND [arguments]\nControls a daemon cauteryd.\n\n", c->out);
	for (int i = 0; c->commands[i]; i++)
		fprintf(c->out, "  %-12s %s\n", c->commands[i]->name, c->commands[i]->summary);
	fputs("\nSESSION may be left out if the daemon has only one session.\n"
	      "`cautery COMMAND --help` describes a command. Options of all commands:\n\n",
	      c->out);
	print_options(c->out, common, COMMON_COUNT);
	fputs("\nExit code: 0 done; 1 the server refused, or the session is faulted or gone;\n"
	      "2 wrong arguments; 3 no server, no answer or connection lost; 4 a local file;\n"
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
		c->token_file = value;
		return true;
	case 2:
		c->context = value;
		return true;
	case 3:
		c->label = value;
		return true;
	case 4:
		return cli_read_number(c, "--timeout", value, 0.01, 86400, &c->timeout_s);
	case 5:
		return c->json = true;
	case 6:
		return c->help = true;
	default:
		return c->version = true;
	}
}

// Finds `name`, of `bytes` bytes, in a table. Returns -1 if it is not there.
static int find_option(const cli_option *options, int count, const char *name, size_t bytes)
{
	for (int i = 0; i < count && options[i].name; i++)
		if (strlen(options[i].name) == bytes && strncmp(options[i].name, name, bytes) == 0)
			return i;
	return -1;
}

static int add_names(const cli_option *options, int count, char (*spelled)[OPTION_BYTES],
                     const char **names, int name_count)
{
	for (int i = 0; i < count && options[i].name; i++, name_count++) {
		snprintf(spelled[name_count], OPTION_BYTES, "--%s", options[i].name);
		names[name_count] = spelled[name_count];
	}
	return name_count;
}

static void complain_of_option(const cli *c, const char *name, size_t bytes)
{
	char wrong[OPTION_BYTES], spelled[CLI_OPTIONS_MAX + COMMON_COUNT][OPTION_BYTES];
	const char *names[CLI_OPTIONS_MAX + COMMON_COUNT];
	int count = add_names(common, COMMON_COUNT, spelled, names, 0);
	if (c->command)
		count = add_names(c->command->options, CLI_OPTIONS_MAX, spelled, names, count);
	snprintf(wrong, sizeof wrong, "--%.*s", (int)bytes, name);
	cli_complain_unknown(c, "option", wrong, names, (size_t)count);
}

// Reads the option at arguments[*at], and advances *at past its value.
static bool read_option(cli *c, char **arguments, int count, int *at)
{
	const char *name = arguments[*at] + 2;
	size_t bytes = strcspn(name, "=");
	int own = c->command ? find_option(c->command->options, CLI_OPTIONS_MAX, name, bytes) : -1;
	int shared = find_option(common, COMMON_COUNT, name, bytes);
	if (own < 0 && shared < 0) {
		complain_of_option(c, name, bytes);
		return false;
	}
	const cli_option *option = own >= 0 ? &c->command->options[own] : &common[shared];
	const char *value = name[bytes] ? name + bytes + 1 : NULL;
	if (option->argument && !value && *at + 1 < count)
		value = arguments[++*at];
	if (!option->argument != !value) {
		cli_complain(c, option->argument ? "--%s needs a value" : "--%s takes no value",
		             option->name);
		return false;
	}
	if (own < 0)
		return take_common(c, shared, value);
	c->values[own] = value ? value : "";
	return true;
}

static const cli_command *find_command(const cli *c, const char *name)
{
	for (int i = 0; c->commands[i]; i++) {
		const cli_command *command = c->commands[i];
		if (strcmp(command->name, name) == 0 || (command->also && strcmp(command->also, name) == 0))
			return command;
	}
	return NULL;
}

// Returns the command for a word that other programs or the protocol use for the same action.
static const char *usual_name(const char *word)
{
	static const char *const others[][2] = {
		{"destroy", "rm"},     {"delete", "rm"},     {"remove", "rm"},    {"list", "ls"},
		{"describe", "info"},  {"show", "info"},     {"status", "info"},  {"new", "create"},
		{"start", "create"},   {"open", "create"},   {"stop", "pause"},   {"continue", "resume"},
		{"advance", "step"},   {"save", "snapshot"}, {"load", "restore"}, {"undo", "rewind"},
		{"download", "export"}};
	for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
		if (strcmp(word, others[i][0]) == 0)
			return others[i][1];
	return NULL;
}

static bool take_command(cli *c, const char *word)
{
	enum { MOST = 64 };
	const char *names[MOST];
	size_t count = 0;
	c->command = find_command(c, word);
	c->word = word;
	if (c->command)
		return true;
	for (; c->commands[count] && count < MOST; count++)
		names[count] = c->commands[count]->name;
	const char *usual = usual_name(word);
	if (usual)
		cli_complain(c, "no command \"%s\": use \"%s\". --help lists all commands", word, usual);
	else
		cli_complain_unknown(c, "command", word, names, count);
	return false;
}

// Finds the command whose two words are c->word and `word`. Returns NULL if there is none.
static const cli_command *find_second(const cli *c, const char *word)
{
	char name[64];
	snprintf(name, sizeof name, "%s %s", c->word, word);
	return c->argument_count ? NULL : find_command(c, name);
}

static bool take_word(cli *c, const char *word)
{
	if (!c->command)
		return take_command(c, word);
	const cli_command *second = find_second(c, word);
	if (second) {
		c->command = second;
		return true;
	}
	if (c->argument_count == CLI_ARGUMENTS_MAX) {
		cli_complain(c, "more than %d arguments", CLI_ARGUMENTS_MAX);
		return false;
	}
	c->arguments[c->argument_count++] = word;
	return true;
}

// Lists the command's own options with their values.
static void list_options(const cli_command *command, char *text, size_t bytes)
{
	size_t used = 0;
	*text = 0;
	for (const cli_option *o = command->options; o->name && used < bytes; o++)
		used += (size_t)snprintf(text + used, bytes - used, "%s--%s%s%s", used ? ", " : "", o->name,
		                         o->argument ? " " : "", o->argument ? o->argument : "");
}

static bool check_arguments(const cli *c)
{
	int most = c->command->most + c->command->session_optional;
	if (c->argument_count >= c->command->least && c->argument_count <= most)
		return true;
	char options[256];
	list_options(c->command, options, sizeof options);
	if (*c->command->arguments)
		cli_complain(c, "the arguments are: %s%s%s", c->command->arguments,
		             *options ? "; options are " : "", options);
	else
		cli_complain(c, "\"%s\": this command takes no arguments", c->arguments[0]);
	return false;
}

int cli_common_options(const cli_option **options)
{
	*options = common;
	return COMMON_COUNT;
}

bool cli_read_words(cli *c, int argument_count, char **arguments)
{
	bool words_only = false;
	c->timeout_s = 30;
	for (int i = 1; i < argument_count; i++) {
		if (!words_only && strcmp(arguments[i], "--") == 0)
			words_only = true;
		else if (!words_only && strcmp(arguments[i], "-h") == 0)
			c->help = true;
		else if (!words_only && strncmp(arguments[i], "--", 2) == 0) {
			if (!read_option(c, arguments, argument_count, &i))
				return false;
		} else if (!take_word(c, arguments[i])) {
			return false;
		}
	}
	return true;
}

bool cli_read(cli *c, int argument_count, char **arguments)
{
	if (!cli_read_words(c, argument_count, arguments))
		return false;
	if (c->help || c->version)
		return true;
	if (!c->command) {
		cli_complain(c, "no command given; --help lists them");
		return false;
	}
	return check_arguments(c);
}

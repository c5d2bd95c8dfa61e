// SPDX-License-Identifier: GPL-3.0-or-later
// The command `completion`: prints completion scripts for shells. The scripts call `cautery
// complete`, which prints the possible next words, so a script stays correct when commands change.
// Commands and options come from the command tables, sessions and scenes from the daemon.
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"

enum { SESSIONS_MAX = 4096, SCENES_MAX = 256 };

#define PATIENCE_S 1.0 // longest wait for the daemon after the Tab key, s

static void offer(const cli *c, const char *word, const char *begin)
{
	if (strncmp(word, begin, strlen(begin)) == 0)
		fprintf(c->out, "%s\n", word);
}

// ---- sessions and scenes of the daemon ----------------------------------------------------------
static void offer_sessions(cli *c, const char *begin)
{
	cau_wire_session_list list = {
		.sessions = {calloc(SESSIONS_MAX, sizeof(cau_wire_session_summary)), 0, SESSIONS_MAX}};
	const cau_wire_session_summary *all = list.sessions.items;
	if (all && !cau_client_call(c->client, CAU_METHOD_SESSION_LIST, &(cau_wire_nothing){0}, &list,
	                            &c->error))
		for (int32_t i = 0; i < list.sessions.count; i++)
			offer(c, all[i].session, begin);
	free(list.sessions.items);
}

static void offer_scenes(cli *c, const char *begin)
{
	cau_wire_scene_summary all[SCENES_MAX];
	cau_wire_scene_list list = {.scenes = {all, 0, SCENES_MAX}};
	if (!cau_client_call(c->client, CAU_METHOD_SCENE_LIST, &(cau_wire_nothing){0}, &list,
	                     &c->error))
		for (int32_t i = 0; i < list.scenes.count; i++)
			offer(c, all[i].name, begin);
}

// Offers words that only the daemon knows. Prints no error if the daemon does not answer, because
// the shell would show the error in the command line.
static void offer_from_daemon(cli *c, void (*offer_them)(cli *c, const char *begin),
                              const char *begin)
{
	FILE *complaints = c->complaints, *nowhere = fopen("/dev/null", "w");
	if (!nowhere)
		return;
	c->complaints = nowhere;
	c->timeout_s = PATIENCE_S;
	if (!cli_connect(c))
		offer_them(c, begin);
	c->complaints = complaints;
	fclose(nowhere);
}

// ---- words --------------------------------------------------------------------------------------
static void offer_options(const cli *c, const cli *line, const char *begin)
{
	char spelled[64];
	const cli_option *options;
	int count = cli_common_options(&options);
	for (int i = 0; i < count && options[i].name; i++) {
		snprintf(spelled, sizeof spelled, "--%s", options[i].name);
		offer(c, spelled, begin);
	}
	for (int i = 0; line->command && i < CLI_OPTIONS_MAX && line->command->options[i].name; i++) {
		snprintf(spelled, sizeof spelled, "--%s", line->command->options[i].name);
		offer(c, spelled, begin);
	}
}

// Offers the first words of all commands. If `first` is given, offers the second words of the
// commands that begin with it.
static void offer_commands(const cli *c, const char *first, const char *begin)
{
	size_t length = strlen(first);
	for (int i = 0; c->commands[i]; i++) {
		const char *name = c->commands[i]->name, *space = strchr(name, ' ');
		if (*first && space && (size_t)(space - name) == length &&
		    strncmp(name, first, length) == 0)
			offer(c, space + 1, begin);
		if (!*first && !space)
			offer(c, name, begin);
		const char *also = c->commands[i]->also; // the alias "context" of "context ls"
		if (!*first && space && also && strlen(also) == (size_t)(space - name) &&
		    strncmp(name, also, strlen(also)) == 0)
			offer(c, also, begin);
	}
}

static void offer_arguments(cli *c, const cli *line, const char *begin)
{
	bool first = line->argument_count == 0;
	const char *arguments = line->command->arguments;
	if (first)
		offer_commands(c, line->word, begin);
	if (line->command == &cli_create && first)
		offer_from_daemon(c, offer_scenes, begin);
	else if (strncmp(arguments, "SESSION...", 10) == 0 ||
	         (first && (line->command->session_optional || strncmp(arguments, "SESSION", 7) == 0)))
		offer_from_daemon(c, offer_sessions, begin);
}

static cli_exit run_complete(cli *c)
{
	// The words before the cursor are read as a command line.
	cli line = {.out = c->out, .complaints = fopen("/dev/null", "w"), .commands = c->commands};
	char *before[CLI_ARGUMENTS_MAX + 1] = {(char *)(uintptr_t) "cautery"};
	int count = c->argument_count;
	const char *begin = count ? c->arguments[count - 1] : "";
	if (!line.complaints)
		return CLI_FILE;
	for (int i = 0; i + 1 < count; i++)
		before[i + 1] = (char *)(uintptr_t)c->arguments[i];
	bool read = cli_read_words(&line, count ? count : 1, before);
	fclose(line.complaints);
	if (!read) // An option's value comes next, and no values can be offered.
		return CLI_DONE;
	c->url = line.url;
	c->token_file = line.token_file;
	c->context = line.context;
	c->label = line.label;
	if (strncmp(begin, "--", 2) == 0)
		offer_options(c, &line, begin);
	else if (!line.command)
		offer_commands(c, "", begin);
	else
		offer_arguments(c, &line, begin);
	return CLI_DONE;
}

// ---- scripts ------------------------------------------------------------------------------------
static const char bash_script[] =
	"# bash completion for cautery: source it, or put it into\n"
	"# ~/.local/share/bash-completion/completions/cautery\n"
	"_cautery() {\n"
	"\tlocal word=${COMP_WORDS[COMP_CWORD]}\n"
	"\tmapfile -t COMPREPLY < <(cautery complete -- \"${COMP_WORDS[@]:1:COMP_CWORD-1}\" \"$word\" "
	"2>/dev/null)\n"
	"}\n"
	"complete -o default -F _cautery cautery\n";

static const char zsh_script[] =
	"#compdef cautery\n"
	"# zsh completion for cautery: put it into a folder of $fpath as _cautery, or source it after\n"
	"# compinit\n"
	"_cautery() {\n"
	"\tlocal -a found\n"
	"\tfound=(${(f)\"$(cautery complete -- ${words[2,CURRENT-1]} \"${words[CURRENT]}\" "
	"2>/dev/null)\"})\n"
	"\tif (( $#found )); then compadd -a found; else _files; fi\n"
	"}\n"
	"if [ \"$funcstack[1]\" = _cautery ]; then _cautery \"$@\"; else compdef _cautery cautery; "
	"fi\n";

static cli_exit run_completion(cli *c)
{
	const char *shell = c->arguments[0];
	static const char *const shells[] = {"bash", "zsh"};
	if (strcmp(shell, "bash") == 0)
		fputs(bash_script, c->out);
	else if (strcmp(shell, "zsh") == 0)
		fputs(zsh_script, c->out);
	else
		return cli_complain_unknown(c, "shell", shell, shells, 2), CLI_USAGE;
	return CLI_DONE;
}

const cli_command cli_complete = {.name = "complete",
                                  .arguments = "-- WORD...",
                                  .summary = "lists the completions of the last word, for shells",
                                  .most = CLI_ARGUMENTS_MAX,
                                  .run = run_complete};

const cli_command cli_completion = {
	.name = "completion",
	.arguments = "bash|zsh",
	.summary = "prints a script that completes words of `cautery` in a shell",
	.help = "bash: source <(cautery completion bash)\n"
			"zsh:  source <(cautery completion zsh), after compinit\n",
	.least = 1,
	.most = 1,
	.run = run_completion};

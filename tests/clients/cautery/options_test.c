// SPDX-License-Identifier: GPL-3.0-or-later
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/cli.h"

typedef struct reading {
	cli c;
	char *said;
	size_t said_bytes;
	bool read;
} reading;

// Reads a command line whose words are separated by single spaces.
static reading read_line(const char *line)
{
	static char copy[1024]; // static, because the result points into it
	char *arguments[200] = {"cautery"};
	int count = 1;
	reading r = {0};
	snprintf(copy, sizeof copy, "%s", line);
	for (char *word = strtok(copy, " "); word; word = strtok(NULL, " "))
		arguments[count++] = word;
	FILE *complaints = open_memstream(&r.said, &r.said_bytes);
	r.c = (cli){.out = complaints, .complaints = complaints, .commands = cli_commands};
	r.read = cli_read(&r.c, count, arguments);
	if (r.read && r.c.help)
		cli_help(&r.c);
	fclose(complaints);
	return r;
}

static void words_and_options_are_told_apart(void **state)
{
	(void)state;
	reading r = read_line("--url ws://a rewind --json d1-knee --timeout=2.5 120");
	assert_true(r.read);
	assert_ptr_equal(r.c.command, &cli_rewind);
	assert_string_equal(r.c.url, "ws://a");
	assert_true(r.c.json);
	assert_true(r.c.timeout_s == 2.5);
	assert_int_equal(r.c.argument_count, 2);
	assert_string_equal(r.c.arguments[0], "d1-knee");
	assert_string_equal(r.c.arguments[1], "120");
	free(r.said);
}

static void expect_said(const char *line, const char *said)
{
	reading r = read_line(line);
	assert_false(r.read);
	assert_string_equal(r.said, said);
	free(r.said);
}

static void mistakes_are_told_with_what_is_right(void **state)
{
	(void)state;
	expect_said("destroy d1-knee",
	            "cautery: no command \"destroy\": use \"rm\". --help lists all commands\n");
	expect_said("rewnd",
	            "cautery: no command \"rewnd\"; did you mean \"rewind\"? --help lists them\n");
	expect_said("step d1-knee 10",
	            "cautery step: the arguments are: [SESSION]; options are --ticks N\n");
}

static void options_of_a_command_have_values(void **state)
{
	(void)state;
	bool bad = false;
	reading r = read_line("fork --paused --tick 7");
	assert_true(r.read);
	assert_string_equal(cli_value(&r.c, "paused"), "");
	assert_string_equal(cli_value(&r.c, "tick"), "7");
	assert_null(cli_value(&r.c, "name"));
	assert_true(cli_number(&r.c, "tick", 0, 10, 1, &bad) == 7);
	assert_false(bad);
	free(r.said);
	r = read_line("tool d1-knee hook move -- -0.01 0 --0");
	assert_true(r.read);
	assert_int_equal(r.c.argument_count, 6);
	free(r.said);
}

static void mistakes_are_told(void **state)
{
	(void)state;
	const struct {
		const char *line, *said;
	} cases[] = {
		{"", "no command given"},
		{"fly", "no command \"fly\"; --help"},
		{"crate fascia", "no command \"crate\"; did you mean \"create\"?"},
		{"ls d1-knee", "\"d1-knee\": this command takes no arguments"},
		{"ls --josn", "no option \"--josn\"; did you mean \"--json\"?"},
		{"fork --pausd", "did you mean \"--paused\"?"},
		{"context use", "the arguments are: NAME"},
		{"rewind", "the arguments are: [SESSION] TICK"},
		{"ls --colour", "no option \"--colour\"; --help"},
		{"ls --json=1", "--json takes no value"},
		{"ls --url", "--url needs a value"},
		{"fork --paused=yes", "--paused takes no value"},
		{"ls --timeout never", "--timeout needs a number"},
		{"ls --timeout 0", "--timeout needs a number"},
		{"ls --timeout nan", "--timeout needs a number"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		reading r = read_line(cases[i].line);
		if (r.read || !strstr(r.said, cases[i].said))
			fail_msg("\"%s\": %s", cases[i].line, r.said);
		free(r.said);
	}
}

static void commands_of_two_words_are_found(void **state)
{
	(void)state;
	const struct {
		const char *line;
		const cli_command *command;
		int arguments;
	} cases[] = {
		{"snapshot", &cli_snapshot, 0},
		{"snapshot d1-ls", &cli_snapshot, 1},
		{"snapshot ls", &cli_snapshots, 0},
		{"snapshot --json ls d1-knee", &cli_snapshots, 1},
		{"snapshot d1-knee --name ls", &cli_snapshot, 1},
		{"snapshots", &cli_snapshots, 0},
		{"context", &cli_context_ls, 0},
		{"context rm here", &cli_context_rm, 1},
		{"timeline", &cli_events, 0},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		reading r = read_line(cases[i].line);
		if (!r.read || r.c.command != cases[i].command || r.c.argument_count != cases[i].arguments)
			fail_msg("\"%s\": %s", cases[i].line, r.said);
		free(r.said);
	}
}

static void help_and_version_are_answered_whatever_else_is_said(void **state)
{
	(void)state;
	reading r = read_line("rewind -h");
	assert_true(r.read && r.c.help);
	free(r.said);
	r = read_line("--version");
	assert_true(r.read && r.c.version);
	free(r.said);
	r = read_line("tool d1-knee hook -- -h");
	assert_true(r.read && !r.c.help);
	free(r.said);
}

static void every_command_has_help(void **state)
{
	(void)state;
	reading all = read_line("--help");
	assert_non_null(strstr(all.said, "Exit code"));
	for (int i = 0; cli_commands[i]; i++) {
		char line[64];
		assert_non_null(strstr(all.said, cli_commands[i]->summary));
		snprintf(line, sizeof line, "%s --help", cli_commands[i]->name);
		reading r = read_line(line);
		assert_true(r.read);
		assert_non_null(strstr(r.said, cli_commands[i]->arguments));
		assert_non_null(strstr(r.said, "--url"));
		for (int o = 0; o < CLI_OPTIONS_MAX && cli_commands[i]->options[o].name; o++)
			assert_non_null(strstr(r.said, cli_commands[i]->options[o].meaning));
		free(r.said);
	}
	free(all.said);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(words_and_options_are_told_apart),
		cmocka_unit_test(mistakes_are_told_with_what_is_right),
		cmocka_unit_test(options_of_a_command_have_values),
		cmocka_unit_test(mistakes_are_told),
		cmocka_unit_test(commands_of_two_words_are_found),
		cmocka_unit_test(help_and_version_are_answered_whatever_else_is_said),
		cmocka_unit_test(every_command_has_help),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

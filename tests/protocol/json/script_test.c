// SPDX-License-Identifier: GPL-3.0-or-later
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <string.h>

#include <cmocka.h>

#include "cautery/command_json.h"

#define GRASP(tick) "{\"tick\":" #tick ",\"command\":\"tool.grasp\",\"tool\":\"a\"}"

static void begin(cau_script *script, const char *text)
{
	cau_script_begin(script, "s.jsonl", text, strlen(text));
}

static void reads_line_by_line(void **state)
{
	(void)state;
	cau_script script;
	cau_command command;
	cau_error error;
	bool end;
	begin(&script, GRASP(1) "\n\n  \t\r\n" GRASP(1) "\r\n" GRASP(5));
	static const int lines[] = {1, 4, 5}, ticks[] = {1, 1, 5};
	for (int i = 0; i < 3; i++) {
		assert_int_equal(cau_script_next(&script, &command, &end, &error), CAU_OK);
		assert_false(end);
		assert_int_equal(script.line, lines[i]);
		assert_int_equal(command.tick, ticks[i]);
	}
	for (int i = 0; i < 2; i++) {
		assert_int_equal(cau_script_next(&script, &command, &end, &error), CAU_OK);
		assert_true(end);
	}
	begin(&script, "");
	assert_int_equal(cau_script_next(&script, &command, &end, NULL), CAU_OK);
	assert_true(end);
}

static void expect_refusal(const char *text, cau_status status, const char *path,
                           const char *reason)
{
	cau_script script;
	cau_command command;
	cau_error error;
	bool end;
	begin(&script, text);
	assert_int_equal(cau_script_next(&script, &command, &end, &error), CAU_OK);
	assert_int_equal(cau_script_next(&script, &command, &end, &error), status);
	assert_false(end);
	assert_string_equal(error.file, "s.jsonl");
	assert_string_equal(error.path, path);
	assert_string_equal(error.reason, reason);
	// The bad line is skipped, and reading continues.
	assert_int_equal(cau_script_next(&script, &command, &end, NULL), CAU_OK);
	assert_false(end);
	assert_int_equal(command.tick, 9);
}

static void errors_name_the_line(void **state)
{
	(void)state;
	expect_refusal(GRASP(3) "\n{\"command\":3}\n" GRASP(9), CAU_BAD_VALUE, "command",
	               "script line 2: a string is needed, not 3");
	expect_refusal(GRASP(3) "\n\n{\n" GRASP(9), CAU_BAD_SYNTAX, "",
	               "script line 3: line 1, column 2 (byte 1): the text ends too early");
	expect_refusal(GRASP(3) "\n" GRASP(2) "\n" GRASP(9), CAU_BAD_VALUE, "tick",
	               "script line 2: 2 after 3: ticks never fall");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reads_line_by_line),
		cmocka_unit_test(errors_name_the_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

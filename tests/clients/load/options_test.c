// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/load.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static bool read_line(const char *line, load_options *options)
{
	static char copy[512];
	char *arguments[32] = {"cautery-load"};
	int count = 1;
	snprintf(copy, sizeof copy, "%s", line);
	for (char *word = strtok(copy, " "); word; word = strtok(NULL, " "))
		arguments[count++] = word;
	FILE *nowhere = fopen("/dev/null", "w");
	bool read = load_options_read(count, arguments, options, nowhere);
	fclose(nowhere);
	return read;
}

static void options_are_read(void **state)
{
	(void)state;
	load_options o;
	assert_true(
		read_line("--url ws://a --sessions 16 --viewers 4 --seconds 2.5 --slow 25 --json", &o));
	assert_string_equal(o.url, "ws://a");
	assert_int_equal(o.sessions, 16);
	assert_int_equal(o.viewers, 4);
	assert_true(o.seconds == 2.5 && o.slow_pct == 25 && o.json);
	assert_string_equal(o.scene, "fascia");
	assert_true(o.rate_hz == 60);
}

static void mistakes_are_refused(void **state)
{
	(void)state;
	static const char *const cases[] = {
		"--sessions 0",  "--sessions 1.5", "--viewers many", "--seconds 0", "--slow 101",
		"--seconds nan", "--fast",         "sixteen",        "--scene",
	};
	load_options o;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		if (read_line(cases[i], &o))
			fail_msg("\"%s\" is taken", cases[i]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(options_are_read),
		cmocka_unit_test(mistakes_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "log/log.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "line_parser.h"

// Returns what one call writes to standard error.
static char *written(void (*call)(void))
{
	static char text[4096];
	char file[] = "/tmp/cautery-log-XXXXXX";
	int descriptor = mkstemp(file), kept = dup(STDERR_FILENO);
	dup2(descriptor, STDERR_FILENO);
	call();
	dup2(kept, STDERR_FILENO);
	ssize_t bytes = pread(descriptor, text, sizeof text - 1, 0);
	text[bytes > 0 ? bytes : 0] = 0;
	close(descriptor);
	close(kept);
	unlink(file);
	return text;
}

static void one(void)
{
	cau_log(CAU_LOG_WARNING, "d1-knee", "tool_cut", "tool=%s", "hook");
}

static void nasty(void)
{
	cau_log(CAU_LOG_INFO, "d1-x event=y", "hello", "name=\"%s\" path=%s",
	        "a\" role=\"admin\nlevel=error\x1b[2J", "a b=c");
}

static void endless(void)
{
	char name[3000];
	memset(name, 'x', sizeof name - 1);
	name[sizeof name - 1] = 0;
	cau_log(CAU_LOG_INFO, NULL, "long", "name=%s", name);
}

static void quiet(void)
{
	cau_log(CAU_LOG_DEBUG, NULL, "detail", "a=%d", 1);
}

static void a_line_has_level_time_session_and_event(void **state)
{
	(void)state;
	unsetenv("JOURNAL_STREAM");
	const char *line = written(one);
	assert_int_equal(strncmp(line, "warning 20", 10), 0);
	assert_non_null(strstr(line, "Z session=d1-knee event=tool_cut tool=hook\n"));
}

static void under_journald_a_line_starts_with_its_priority(void **state)
{
	(void)state;
	setenv("JOURNAL_STREAM", "1:2", 1);
	assert_int_equal(strncmp(written(one), "<4>warning", 10), 0);
	unsetenv("JOURNAL_STREAM");
}

static void what_clients_send_cannot_forge_lines(void **state)
{
	(void)state;
	const char *line = written(nasty);
	line_fields fields;
	assert_ptr_equal(strchr(line, '\n'), line + strlen(line) - 1);
	assert_null(strchr(line, '\x1b'));
	const char *tail = strstr(line, "Z ") + 2; // the part behind the level and the time
	assert_true(line_parse(tail, strlen(tail) - 1, &fields));
	assert_int_equal(fields.count, 4);
	assert_string_equal(fields.fields[0].value, "d1-x event=y");
	assert_string_equal(fields.fields[1].value, "hello");
	assert_string_equal(fields.fields[2].value, "a\" role=\"admin\nlevel=error\x1b[2J");
	assert_string_equal(fields.fields[3].value, "a b=c");
	line = written(endless);
	assert_true(strlen(line) <= 1024);
	assert_ptr_equal(strchr(line, '\n'), line + strlen(line) - 1);
}

static void in_json_a_line_is_an_object(void **state)
{
	(void)state;
	assert_true(cau_log_set_format("json"));
	const char *line = written(one);
	assert_int_equal(strncmp(line, "{\"level\":\"warning\",\"time\":\"20", 29), 0);
	assert_non_null(
		strstr(line, "Z\",\"session\":\"d1-knee\",\"event\":\"tool_cut\",\"tool\":\"hook\"}\n"));
	setenv("JOURNAL_STREAM", "1:2", 1);
	assert_int_equal(strncmp(written(one), "<4>{", 4), 0);
	unsetenv("JOURNAL_STREAM");
	assert_false(cau_log_set_format("xml"));
	assert_true(cau_log_set_format("text"));
}

static void levels_below_the_least_are_left_out(void **state)
{
	(void)state;
	assert_string_equal(written(quiet), "");
	assert_true(cau_log_set_level("debug"));
	assert_true(strlen(written(quiet)) > 0);
	assert_false(cau_log_set_level("chatty"));
	assert_true(cau_log_set_level("info"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_line_has_level_time_session_and_event),
		cmocka_unit_test(under_journald_a_line_starts_with_its_priority),
		cmocka_unit_test(what_clients_send_cannot_forge_lines),
		cmocka_unit_test(in_json_a_line_is_an_object),
		cmocka_unit_test(levels_below_the_least_are_left_out),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

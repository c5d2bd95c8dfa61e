// SPDX-License-Identifier: GPL-3.0-or-later
#include "agent/agent.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static cau_load idle(void)
{
	return (cau_load){
		.takes = true, .session_count_most = 64, .session_bytes_most = 1000, .pace_share_min = 1};
}

static void the_least_free_share_counts(void **state)
{
	cau_load load = idle();
	assert_int_equal(cau_load_free_percent(&load), 100);
	load.session_count = 16;
	assert_int_equal(cau_load_free_percent(&load), 75);
	load.session_bytes = 370;
	assert_int_equal(cau_load_free_percent(&load), 63);
	load.busy_share = 0.8;
	assert_int_equal(cau_load_free_percent(&load), 20);
	(void)state;
}

static void sessions_that_are_behind_make_it_less(void **state)
{
	cau_load load = idle();
	load.busy_share = 0.5;
	load.pace_share_min = 0.5;
	assert_int_equal(cau_load_free_percent(&load), 25);
	// The share is above 1 while the session catches up.
	load.pace_share_min = 1.02;
	assert_int_equal(cau_load_free_percent(&load), 50);
	(void)state;
}

static void a_full_daemon_is_no_draining_one(void **state)
{
	char line[CAU_LOAD_LINE_BYTES];
	cau_load load = idle();
	load.session_count = 65; // a session that is ending is still counted
	load.busy_share = 1;
	size_t bytes = cau_load_write(&load, line);
	assert_string_equal(line, "ready 1%\n");
	assert_int_equal(bytes, strlen(line));
	(void)state;
}

static void lines_are_those_of_haproxy(void **state)
{
	char line[CAU_LOAD_LINE_BYTES];
	cau_load load = idle();
	assert_int_equal(cau_load_write(&load, line), strlen("ready 100%\n"));
	assert_string_equal(line, "ready 100%\n");
	load.takes = false;
	assert_int_equal(cau_load_write(&load, line), strlen("drain\n"));
	assert_string_equal(line, "drain\n");
	(void)state;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_least_free_share_counts),
		cmocka_unit_test(sessions_that_are_behind_make_it_less),
		cmocka_unit_test(a_full_daemon_is_no_draining_one),
		cmocka_unit_test(lines_are_those_of_haproxy),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

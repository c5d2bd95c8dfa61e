// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/progress.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// Returns the text that a progress writes to a file that is not a terminal.
static char *written(const uint64_t *done, int count, uint64_t total, const char *note)
{
	cli_progress progress;
	FILE *file = tmpfile();
	char *text = calloc(1, 4096);
	cli_progress_begin(&progress, file, "knee.msh");
	for (int i = 0; i < count; i++)
		cli_progress_show(&progress, done[i], total, note);
	cli_progress_end(&progress);
	rewind(file);
	size_t bytes = fread(text, 1, 4095, file);
	text[bytes] = 0;
	fclose(file);
	return text;
}

static void a_line_for_every_tenth(void **state)
{
	(void)state;
	const uint64_t done[] = {0, 1, 5, 10, 11, 19, 35, 100, 100};
	char *text = written(done, 9, 100, NULL);
	assert_string_equal(text, "knee.msh 0 %\nknee.msh 10 %\nknee.msh 30 %\nknee.msh 100 %\n");
	free(text);
}

static void notes_follow(void **state)
{
	(void)state;
	const uint64_t done[] = {7};
	char *text = written(done, 1, 10, "3 faces gone");
	assert_string_equal(text, "knee.msh 70 % 3 faces gone\n");
	free(text);
}

static void nothing_to_do_is_done(void **state)
{
	(void)state;
	const uint64_t done[] = {0};
	char *text = written(done, 1, 0, NULL);
	assert_string_equal(text, "knee.msh 100 %\n");
	free(text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_line_for_every_tenth),
		cmocka_unit_test(notes_follow),
		cmocka_unit_test(nothing_to_do_is_done),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// A failed assertion ends the program with its message. A build without assertions continues.
#include "cautery/assert.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/memory.h"
#include "cautery/defaults.h"
#include "tool/tool_shape.h"

#ifdef CAU_ASSERTIONS
static const int on = 1;
#else
static const int on = 0;
#endif

enum { WORDS_BYTES = 4096 };

// Runs `deed` in a child process. Returns its wait status; `words` gets its stderr.
static int child_of(void (*deed)(void), char words[WORDS_BYTES])
{
	int ends[2], status = 0;
	size_t length = 0;
	assert_int_equal(pipe(ends), 0);
	pid_t child = fork();
	assert_true(child >= 0);
	if (!child) {
		dup2(ends[1], STDERR_FILENO);
		close(ends[0]);
		deed();
		_exit(0);
	}
	close(ends[1]);
	for (ssize_t got; length < WORDS_BYTES - 1; length += (size_t)got)
		if ((got = read(ends[0], words + length, WORDS_BYTES - 1 - length)) <= 0)
			break;
	words[length] = 0;
	close(ends[0]);
	assert_int_equal(waitpid(child, &status, 0), child);
	return status;
}

static void deny(void)
{
	volatile int kept = 2, most = 1;
	CAU_ASSERT(kept <= most, "%d are kept of at most %d", kept, most);
}

static void go_beyond(void)
{
	volatile int32_t number = -1;
	CAU_ASSERT_INDEX(number, 3);
}

static void take_a_shape_that_is_none(void)
{
	cau_tool_def tool;
	cau_default_tool_def(&tool, CAU_TOOL_SPHERE);
	tool.shape = CAU_TOOL_SHAPE_COUNT;
	if (on) // without assertions the call would read beyond a table
		cau_tool_thinnest_hot_m(&tool);
}

static void take_nothing_apart(void)
{
	cau_arena arena = {0};
	if (on)
		cau_arena_copy(&arena, NULL, 3, 8);
}

static void expect_end(void (*deed)(void), const char *const *told)
{
	char words[WORDS_BYTES];
	int status = child_of(deed, words);
	if (!on) {
		assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
		assert_string_equal(words, "");
		return;
	}
	assert_true(WIFSIGNALED(status));
	assert_int_equal(WTERMSIG(status), SIGABRT);
	for (; *told; told++)
		if (!strstr(words, *told))
			fail_msg("\"%s\" is not said in \"%s\"", *told, words);
}

static void test_condition_file_line_and_case_are_told(void **state)
{
	(void)state;
	const char *told[] = {"assert_test.c:", ": deny: kept <= most does not hold: ",
	                      "2 are kept of at most 1\n", NULL};
	expect_end(deny, told);
	expect_end(go_beyond, (const char *[]){"number", "number -1 of 3\n", NULL});
}

static void test_rooms_say_what_they_were_asked(void **state)
{
	(void)state;
	expect_end(take_a_shape_that_is_none, (const char *[]){"tool_shape.c:", NULL});
	expect_end(take_nothing_apart, (const char *[]){"memory.c:", NULL});
}

static int asked;

static int ask(int answer)
{
	asked++;
	return answer;
}

// The condition is evaluated once if assertions are on, and never if they are off.
static void test_a_condition_is_no_deed(void **state)
{
	(void)state;
	asked = 0;
	CAU_ASSERT(ask(1), "%d", asked);
	assert_int_equal(asked, on);
}

// An assertion is one statement: both branches of an if stay complete.
static void test_it_is_one_statement(void **state)
{
	(void)state;
	int reached = 0;
	if (state != NULL)
		CAU_ASSERT(state != NULL, "%d", reached);
	else
		reached = 1;
	assert_int_equal(reached, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_condition_file_line_and_case_are_told),
		cmocka_unit_test(test_rooms_say_what_they_were_asked),
		cmocka_unit_test(test_a_condition_is_no_deed),
		cmocka_unit_test(test_it_is_one_statement),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

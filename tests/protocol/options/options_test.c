// SPDX-License-Identifier: GPL-3.0-or-later
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/options.h"

typedef struct asked {
	const char *scene;
	double seconds;
	int32_t threads;
	int64_t tick;
	int solver;
	double from_m[3];
	bool cut, help;
	const char *words[2];
} asked;

#define AT(member) offsetof(asked, member)

static const char *const solvers[] = {"cholesky", "diagonal", NULL};
static const cau_option rows[] = {
	{"scene", "NAME", CAU_OPTION_TEXT, AT(scene), .meaning = "of the run"},
	{"seconds", "T", CAU_OPTION_NUMBER, AT(seconds), 0.5, 10, .meaning = "how long"},
	{"threads", "N", CAU_OPTION_WHOLE, AT(threads), 1, 16, .meaning = "of a step"},
	{"tick", "K", CAU_OPTION_LONG, AT(tick), 0, 1e15, .meaning = "first one"},
	{"solver", "S", CAU_OPTION_CHOICE, AT(solver), .choices = solvers, .meaning = "one\nof two"},
	{"from", "X,Y,Z", CAU_OPTION_POINT, AT(from_m), .meaning = "m"},
	{"cut", NULL, CAU_OPTION_FLAG, AT(cut), .meaning = "cut"},
	{"help", NULL, CAU_OPTION_HELP, AT(help), .meaning = "this text"},
};
static const cau_command_line line = {.program = "example",
                                      .words = "SESSION TOOL",
                                      .word_count = 2,
                                      .summary = "Does it.\n",
                                      .closing = "Exit code: 0.\n",
                                      .rows = rows,
                                      .row_count = sizeof rows / sizeof *rows};

enum { COMPLAINT_BYTES = 512, MOST = 16 };

// Reads words that are separated by blanks. Error messages go to `complaint`.
static bool read_text(const char *text, asked *to, char complaint[COMPLAINT_BYTES])
{
	static char copy[512]; // static, because the result points into it
	char *arguments[MOST] = {"example"};
	int count = 1;
	snprintf(copy, sizeof copy, "%s", text);
	for (char *word = strtok(copy, " "); word; word = strtok(NULL, " "))
		arguments[count++] = word;
	*to = (asked){.threads = 3, .solver = -1};
	memset(complaint, 0, COMPLAINT_BYTES);
	FILE *out = fmemopen(complaint, COMPLAINT_BYTES, "w");
	bool read = cau_options_read(&line, count, arguments, to, to->words, out);
	fclose(out);
	return read;
}

static void each_kind_is_read(void **state)
{
	(void)state;
	asked a;
	char complaint[COMPLAINT_BYTES];
	assert_true(read_text("--scene fat knee --seconds=2.5 --threads 16 --tick 9007199254740 "
	                      "--solver diagonal --from -1,2e-3,3 --cut t",
	                      &a, complaint));
	assert_string_equal(complaint, "");
	assert_string_equal(a.scene, "fat");
	assert_true(a.seconds == 2.5 && a.from_m[0] == -1 && a.from_m[1] == 2e-3 && a.from_m[2] == 3);
	assert_int_equal(a.threads, 16);
	assert_true(a.tick == 9007199254740);
	assert_int_equal(a.solver, 1);
	assert_true(a.cut);
	assert_string_equal(a.words[0], "knee");
	assert_string_equal(a.words[1], "t");
}

static void what_is_not_named_stays(void **state)
{
	(void)state;
	asked a;
	char complaint[COMPLAINT_BYTES];
	assert_true(read_text("a b", &a, complaint));
	assert_int_equal(a.threads, 3);
	assert_int_equal(a.solver, -1);
	assert_false(a.cut || a.help);
	assert_null(a.scene);
}

static void words_may_look_like_options(void **state)
{
	(void)state;
	asked a;
	char complaint[COMPLAINT_BYTES];
	assert_true(read_text("--cut -- --scene -h", &a, complaint));
	assert_string_equal(a.words[0], "--scene");
	assert_string_equal(a.words[1], "-h");
	assert_false(a.help);
}

static void mistakes_say_what_would_be_right(void **state)
{
	(void)state;
	static const struct {
		const char *text, *complaint;
	} cases[] = {
		{"a b --seconds 11", "example: --seconds needs a number from 0.5 to 10, not \"11\"\n"},
		{"a b --seconds nan", "example: --seconds needs a number from 0.5 to 10, not \"nan\"\n"},
		{"a b --seconds=", "example: --seconds needs a number from 0.5 to 10, not \"\"\n"},
		{"a b --seconds 1x", "example: --seconds needs a number from 0.5 to 10, not \"1x\"\n"},
		{"a b --threads 1.5", "example: --threads needs a whole number, not \"1.5\"\n"},
		{"a b --threads 17", "example: --threads needs a number from 1 to 16, not \"17\"\n"},
		{"a b --solver lu", "example: --solver is one of cholesky, diagonal; not \"lu\"\n"},
		{"a b --from 1,2", "example: --from needs three numbers X,Y,Z, not \"1,2\"\n"},
		{"a b --from 1,2,3,4", "example: --from needs three numbers X,Y,Z, not \"1,2,3,4\"\n"},
		{"a b --from 1,2,inf", "example: --from needs three numbers X,Y,Z, not \"1,2,inf\"\n"},
		{"a b --scene", "example: --scene needs a value\n"},
		{"a b --cut=1", "example: --cut takes no value\n"},
		{"a b --secnods 1", "example: there is no option --secnods: did you mean --seconds?\n"},
		{"a b --annihilate", "example: there is no option --annihilate (--help lists them)\n"},
		{"a", "example: needs the arguments SESSION TOOL (see --help)\n"},
		{"a b c", "example: the argument \"c\" is not expected here\n"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		asked a;
		char complaint[COMPLAINT_BYTES];
		assert_false(read_text(cases[i].text, &a, complaint));
		assert_string_equal(complaint, cases[i].complaint);
	}
}

static void help_wants_nothing_else(void **state)
{
	(void)state;
	asked a;
	char complaint[COMPLAINT_BYTES];
	assert_true(read_text("--help", &a, complaint) && a.help);
	assert_true(read_text("-h", &a, complaint) && a.help);
	assert_true(read_text("--cut --help --nonsense", &a, complaint) && a.help);
}

static void help_has_each_row(void **state)
{
	(void)state;
	char text[2048] = "";
	FILE *out = fmemopen(text, sizeof text, "w");
	cau_options_help(&line, out);
	fclose(out);
	assert_string_equal(text, "example [options] SESSION TOOL\n"
	                          "Does it.\n"
	                          "\n"
	                          "  --scene NAME  of the run\n"
	                          "  --seconds T   how long\n"
	                          "  --threads N   of a step\n"
	                          "  --tick K      first one\n"
	                          "  --solver S    one\n"
	                          "                of two\n"
	                          "  --from X,Y,Z  m\n"
	                          "  --cut         cut\n"
	                          "  --help        this text\n"
	                          "\n"
	                          "Exit code: 0.\n");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_kind_is_read),
		cmocka_unit_test(what_is_not_named_stays),
		cmocka_unit_test(words_may_look_like_options),
		cmocka_unit_test(mistakes_say_what_would_be_right),
		cmocka_unit_test(help_wants_nothing_else),
		cmocka_unit_test(help_has_each_row),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

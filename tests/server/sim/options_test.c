// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/run.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 16 };

// Reads a command line that is given as words. The error message goes to `complaint`.
static bool read_words(const char *const *words, sim_options *options, char *complaint,
                       size_t bytes)
{
	static char copies[MOST][64]; // the options borrow their texts from the arguments
	char *arguments[MOST + 1] = {0};
	int count = 0;
	for (; words[count]; count++) {
		snprintf(copies[count], sizeof copies[count], "%s", words[count]);
		arguments[count] = copies[count];
	}
	FILE *out = fmemopen(complaint, bytes, "w");
	bool ok = sim_options_read(count, arguments, options, out);
	fclose(out);
	return ok;
}

static void defaults_stand(void **state)
{
	(void)state;
	sim_options o;
	char complaint[256];
	assert_true(read_words((const char *[]){"sim", "--scene", "fat", NULL}, &o, complaint,
	                       sizeof complaint));
	assert_string_equal(o.scene, "fat");
	assert_true(o.seconds < 0.0 && o.threads == 1 && o.unit_m == 0 && o.snapshot_at < 0);
	assert_null(o.script);
	assert_false(o.cut || o.json || o.help || o.print_cut);
}

static void every_option_is_read(void **state)
{
	(void)state;
	sim_options o;
	char complaint[256];
	assert_true(
		read_words((const char *[]){"sim", "--scene=a.msh", "--scenes=d", "--cut", "--seconds=2.5",
	                                "--threads=2", "--unit-m=0.001", "--snapshot-at=7", "--vtu=v",
	                                "--vtu-every=3", "--csv=c", "--json", NULL},
	               &o, complaint, sizeof complaint));
	assert_true(o.seconds == 2.5 && o.threads == 2 && o.unit_m == 0.001 && o.snapshot_at == 7 &&
	            o.vtu_every == 3 && o.cut && o.json);
	assert_string_equal(o.scenes, "d");
	assert_string_equal(o.vtu, "v");
	assert_string_equal(o.csv, "c");
	assert_true(
		read_words((const char *[]){"sim", "--help", NULL}, &o, complaint, sizeof complaint));
	assert_true(o.help);
}

static void mistakes_are_named(void **state)
{
	(void)state;
	static const char *const lines[][6] = {
		{"sim", NULL},
		{"sim", "--scene", "a", "extra", NULL},
		{"sim", "--scene", "a", "--threads=0", NULL},
		{"sim", "--scene", "a", "--threads=1.5", NULL},
		{"sim", "--scene", "a", "--threads=17", NULL},
		{"sim", "--scene", "a", "--seconds=-1", NULL},
		{"sim", "--scene", "a", "--seconds=nan", NULL},
		{"sim", "--scene", "a", "--seconds=1x", NULL},
		{"sim", "--scene", "a", "--seconds=", NULL},
		{"sim", "--scene", "a", "--cut", "--script=b", NULL},
	};
	static const char *const parts[] = {"--scene",   "\"extra\"", "--threads", "--threads",
	                                    "--threads", "--seconds", "--seconds", "--seconds",
	                                    "--seconds", "--cut"};
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		sim_options o;
		char complaint[256] = "";
		assert_false(read_words(lines[i], &o, complaint, sizeof complaint));
		if (!strstr(complaint, parts[i]))
			fail_msg("line %zu: \"%s\" does not name %s", i, complaint, parts[i]);
	}
}

static void help_names_every_option(void **state)
{
	(void)state;
	static const char *const names[] = {"--scene S",   "--scenes",    "--script",      "--cut",
	                                    "--print-cut", "--seconds",   "--threads",     "--unit-m",
	                                    "--vtu DIR",   "--vtu-every", "--snapshot-at", "--csv",
	                                    "--json",      "--help",      "Exit code"};
	char text[4096] = "";
	FILE *out = fmemopen(text, sizeof text, "w");
	sim_options_help(out);
	fclose(out);
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		assert_non_null(strstr(text, names[i]));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(defaults_stand),
		cmocka_unit_test(every_option_is_read),
		cmocka_unit_test(mistakes_are_named),
		cmocka_unit_test(help_names_every_option),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/nearest.h"

static const char *const words[] = {"create", "record", "restore", "reset", "rm", "ls", "events"};
enum { COUNT = sizeof words / sizeof *words };

static void what_was_meant_is_found(void **state)
{
	(void)state;
	const struct {
		const char *word, *meant; // `meant` is NULL if no word is near
	} cases[] = {
		{"create", "create"},
		{"crate", "create"},   // a letter left out
		{"creaete", "create"}, // one letter added
		{"creste", "create"},  // one letter replaced
		{"craete", "create"},  // two letters swapped
		{"recrod", "record"},
		{"eventts", "events"},
		{"rset", "reset"},
		{"restor", "restore"},
		{"sl", "ls"},
		{"ev", "events"}, // the end left out
		{"re", "record"}, // the first of several words
		{"x", NULL},      // a word of one letter may have no slip
		{"", NULL},
		{"fly", NULL},
		{"annihilate", NULL},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const char *found = cau_nearest(cases[i].word, words, COUNT);
		if (found != cases[i].meant &&
		    (!found || !cases[i].meant || strcmp(found, cases[i].meant) != 0))
			fail_msg("\"%s\" meant \"%s\"", cases[i].word, found ? found : "nothing");
	}
}

// Members of objects: other upper and lower case, and units left out.
static void members_are_found(void **state)
{
	(void)state;
	static const char *const names[] = {"poisson_ratio", "young_modulus_pa", "density_kg_m3",
	                                    "limit", "limit_stiffness_pa"};
	enum { NAMES = sizeof names / sizeof *names };
	assert_string_equal(cau_nearest("posson_ratio", names, NAMES), "poisson_ratio");
	assert_string_equal(cau_nearest("poisson_raito", names, NAMES), "poisson_ratio");
	assert_string_equal(cau_nearest("youngModulusPa", names, NAMES), "young_modulus_pa");
	assert_string_equal(cau_nearest("Limit", names, NAMES), "limit");
	assert_string_equal(cau_nearest("density", names, NAMES), "density_kg_m3");
	assert_null(cau_nearest("temperature_c", names, NAMES));
	assert_null(cau_nearest("x", names, NAMES));
	assert_null(cau_nearest("", names, NAMES));
	assert_null(cau_nearest("limit", names, 0));
	assert_null(cau_nearest("limit_limit_limit_limit_limit_limit_limit_limit_limit", names, NAMES));
}

static void long_words_mean_nothing(void **state)
{
	char word[4096];
	(void)state;
	memset(word, 'e', sizeof word);
	word[sizeof word - 1] = 0;
	assert_null(cau_nearest(word, words, COUNT));
	assert_null(cau_nearest("create", &(const char *){word}, 1));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_was_meant_is_found),
		cmocka_unit_test(members_are_found),
		cmocka_unit_test(long_words_mean_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

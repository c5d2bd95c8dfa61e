// SPDX-License-Identifier: GPL-3.0-or-later
// Tests where a program finds its files. In the build tree, this program is in the same folder,
// relative to the files, as an installed program.
#include "places/places.h"

#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static void scenes_are_beside_the_program(void **state)
{
	(void)state;
	char path[PATH_MAX], scene[PATH_MAX + 32];
	assert_true(cau_place_find("scenes", path, sizeof path));
	assert_int_equal(path[0], '/');
	snprintf(scene, sizeof scene, "%s/fascia.json", path);
	assert_int_equal(access(scene, R_OK), 0);
}

static void what_is_not_there_is_not_found(void **state)
{
	(void)state;
	char path[PATH_MAX] = "before";
	assert_false(cau_place_find("nowhere", path, sizeof path));
	assert_string_equal(path, "");
	assert_false(cau_place_find("scenes/fascia.json", path, sizeof path)); // a file, not a folder
	assert_string_equal(path, "");
}

static void a_name_that_does_not_fit_is_not_cut_short(void **state)
{
	(void)state;
	char path[PATH_MAX];
	assert_true(cau_place_find("scenes", path, sizeof path));
	size_t bytes = strlen(path) + 1;
	assert_true(cau_place_find("scenes", path, bytes));
	assert_false(cau_place_find("scenes", path, bytes - 1));
	assert_string_equal(path, "");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(scenes_are_beside_the_program),
		cmocka_unit_test(what_is_not_there_is_not_found),
		cmocka_unit_test(a_name_that_does_not_fit_is_not_cut_short),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

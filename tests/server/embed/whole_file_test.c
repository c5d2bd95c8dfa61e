// SPDX-License-Identifier: GPL-3.0-or-later
#include "embed/whole_file.h"

#include "server/sim/sim_fixture.h"

static void files_have_a_largest_size(void **state)
{
	(void)state;
	char *text;
	size_t bytes;
	cau_error error = {0};
	const char *path = fixture_path("ten");
	fixture_write(path, "0123456789");
	assert_int_equal(embed_read_file(path, 9, &text, &bytes, &error), CAU_LIMIT);
	assert_int_equal(embed_read_file(path, 10, &text, &bytes, &error), CAU_OK);
	assert_int_equal(bytes, 10);
	assert_string_equal(text, "0123456789");
	free(text);
	assert_int_equal(embed_read_file(fixture_folder(), 10, &text, &bytes, &error), CAU_IO);
}

static void an_error_names_the_file_and_is_not_needed(void **state)
{
	(void)state;
	char *text;
	size_t bytes;
	cau_error error = {0};
	assert_int_equal(embed_read_file("/nowhere/ten", 10, &text, &bytes, &error), CAU_IO);
	assert_string_equal(error.file, "/nowhere/ten");
	assert_non_null(strstr(error.reason, "cannot open"));
	assert_null(text);
	assert_int_equal(embed_read_file("/nowhere/ten", 10, &text, &bytes, NULL), CAU_IO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(files_have_a_largest_size),
		cmocka_unit_test(an_error_names_the_file_and_is_not_needed),
	};
	return cmocka_run_group_tests(tests, NULL, fixture_remove);
}

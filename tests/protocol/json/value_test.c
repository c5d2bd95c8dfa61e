// SPDX-License-Identifier: GPL-3.0-or-later
#include "json/value.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/scene.h"

static cJSON *parse(const char *text)
{
	cJSON *value = NULL;
	cau_error error = {0};
	if (cau_value_parse(text, strlen(text), 1 << 16, &value, &error))
		fail_msg("%s: %s", text, error.reason);
	return value;
}

typedef struct fixture {
	cJSON *value;
	cau_error error;
	cau_reader reader;
} fixture;

static void begin(fixture *f, const char *text)
{
	memset(f, 0, sizeof *f);
	f->value = parse(text);
	cau_reader_begin(&f->reader, "at", &f->error);
}

static void end(fixture *f, const char *path, const char *reason)
{
	assert_int_equal(f->reader.status, reason ? CAU_BAD_VALUE : CAU_OK);
	assert_string_equal(f->error.path, reason ? path : "");
	assert_string_equal(f->error.reason, reason ? reason : "");
	assert_string_equal(f->reader.path, "at");
	cJSON_Delete(f->value);
}

static void paths_grow_and_shrink(void **state)
{
	(void)state;
	cau_reader reader;
	cau_reader_begin(&reader, NULL, NULL);
	size_t outer = cau_reader_enter(&reader, "layers", 0);
	size_t inner = cau_reader_enter(&reader, NULL, 11);
	cau_reader_enter(&reader, "poisson_ratio", 0);
	assert_string_equal(reader.path, "layers[11].poisson_ratio");
	cau_reader_leave(&reader, inner);
	assert_string_equal(reader.path, "layers");
	cau_reader_leave(&reader, outer);
	assert_string_equal(reader.path, "");
	for (int i = 0; i < 100; i++) // far beyond the capacity of the path
		cau_reader_enter(&reader, "member", 0);
	assert_int_equal(strlen(reader.path), sizeof reader.path - 1);
	assert_int_equal(cau_reader_fail(&reader, CAU_LIMIT, "x", "first"), CAU_LIMIT);
	assert_int_equal(cau_reader_fail(&reader, CAU_IO, "x", "second"), CAU_LIMIT);
}

static void numbers_say_range_and_unit(void **state)
{
	(void)state;
	fixture f;
	begin(&f, "0.25");
	assert_true(cau_read_number(&f.reader, f.value, 0.0, 1.0, "m") == 0.25);
	end(&f, NULL, NULL);
	begin(&f, "2");
	cau_read_number(&f.reader, f.value, 0.0, 1.5, "kg/m^3");
	end(&f, "at", "2 is outside 0 to 1.5 kg/m^3");
	begin(&f, "-2");
	cau_read_number(&f.reader, f.value, 0.0, 1.5, "1");
	end(&f, "at", "-2 is outside 0 to 1.5");
	begin(&f, "\"2\"");
	cau_read_number(&f.reader, f.value, 0.0, 1.5, "m");
	end(&f, "at", "a number is needed, not \"2\"");
	begin(&f, "null");
	cau_read_number(&f.reader, f.value, 0.0, 1.5, "m");
	end(&f, "at", "a number is needed, not null");
	begin(&f, "1");
	cau_read_number(&f.reader, NULL, 0.0, 1.5, "m");
	end(&f, "at", "missing: a number is needed");
}

static void integers_are_whole(void **state)
{
	(void)state;
	fixture f;
	begin(&f, "7");
	assert_int_equal(cau_read_integer(&f.reader, f.value, 1, 8), 7);
	end(&f, NULL, NULL);
	begin(&f, "7.5");
	cau_read_integer(&f.reader, f.value, 1, 8);
	end(&f, "at", "an integer is needed, not 7.5");
	begin(&f, "1e300");
	cau_read_integer(&f.reader, f.value, 1, 8);
	assert_int_equal(f.reader.status, CAU_BAD_VALUE);
	cJSON_Delete(f.value);
	begin(&f, "9");
	cau_read_integer(&f.reader, f.value, 1, 8);
	end(&f, "at", "9 is outside 1 to 8");
	begin(&f, "true");
	cau_read_integer(&f.reader, f.value, 0, 8);
	end(&f, "at", "an integer is needed, not true");
}

static void text_fits_or_fails(void **state)
{
	(void)state;
	fixture f;
	char text[4];
	begin(&f, "\"abc\"");
	cau_read_text(&f.reader, f.value, text, sizeof text);
	assert_string_equal(text, "abc");
	end(&f, NULL, NULL);
	begin(&f, "\"abcd\"");
	cau_read_text(&f.reader, f.value, text, sizeof text);
	end(&f, "at", "4 bytes of text, at most 3 are allowed");
	begin(&f, "{}");
	cau_read_text(&f.reader, f.value, text, sizeof text);
	end(&f, "at", "a string is needed, not an object");
}

static void names_follow_the_rule(void **state)
{
	(void)state;
	static const char *const good[] = {"\"a\"", "\"hook-2_left\"", "\"x9\"",
	                                   "\"a23456789012345678901234567890123456789012345678\""};
	static const char *const bad[] = {"\"\"",     "\"A\"",   "\"9a\"",   "\"a-\"",      "\"-a\"",
	                                  "\"a--b\"", "\"a b\"", "\"a_-b\"", "\"\xc3\xa9\""};
	fixture f;
	char name[CAU_NAME_BYTES];
	for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
		begin(&f, good[i]);
		cau_read_name(&f.reader, f.value, name);
		end(&f, NULL, NULL);
	}
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		begin(&f, bad[i]);
		cau_read_name(&f.reader, f.value, name);
		assert_int_equal(f.reader.status, CAU_BAD_VALUE);
		assert_non_null(strstr(f.error.reason, "is not a name: [a-z]"));
		cJSON_Delete(f.value);
	}
	begin(&f, "\"a234567890123456789012345678901234567890123456789\"");
	cau_read_name(&f.reader, f.value, name);
	end(&f, "at", "49 bytes of text, at most 48 are allowed");
}

static void choices_list_and_suggest(void **state)
{
	(void)state;
	static const char *const names[] = {"none", "target", "range"};
	fixture f;
	begin(&f, "\"range\"");
	assert_int_equal(cau_read_choice(&f.reader, f.value, names, 3), 2);
	end(&f, NULL, NULL);
	begin(&f, "\"Target\"");
	assert_int_equal(cau_read_choice(&f.reader, f.value, names, 3), -1);
	end(&f, "at", "\"Target\" is none of none, target, range; did you mean \"target\"?");
	begin(&f, "\"zzzzzzzz\"");
	cau_read_choice(&f.reader, f.value, names, 3);
	end(&f, "at", "\"zzzzzzzz\" is none of none, target, range");
	begin(&f, "1");
	cau_read_choice(&f.reader, f.value, names, 3);
	end(&f, "at", "a string is needed, not 1");
}

static void rotations_are_checked_and_normalised(void **state)
{
	(void)state;
	fixture f;
	double r[4];
	begin(&f, "[0.7071, 0.7071, 0, 0]");
	cau_read_rotation(&f.reader, f.value, r);
	double square = r[0] * r[0] + r[1] * r[1];
	assert_true(square > 1.0 - 1e-15 && square < 1.0 + 1e-15);
	end(&f, NULL, NULL);
	begin(&f, "[0.9, 0, 0, 0]");
	cau_read_rotation(&f.reader, f.value, r);
	end(&f, "at", "a quaternion of length 0.9, not within 0.001 of 1");
	begin(&f, "[0, 0, 0, 0]");
	cau_read_rotation(&f.reader, f.value, r);
	end(&f, "at", "a quaternion of length 0, not within 0.001 of 1");
	begin(&f, "[1, 0, 0]");
	cau_read_rotation(&f.reader, f.value, r);
	end(&f, "at", "an array of 4 is needed, not an array of 3");
	begin(&f, "[1, 0, \"0\", 0]");
	cau_read_rotation(&f.reader, f.value, r);
	end(&f, "at[2]", "a number is needed, not \"0\"");
}

static void unknown_members_are_named(void **state)
{
	(void)state;
	static const char *const names[] = {"kind", "radius_m"};
	fixture f;
	begin(&f, "{\"kind\": 1, \"radius\": 2}");
	cau_read_no_others(&f.reader, f.value, names, 2);
	end(&f, "at.radius", "unknown: did you mean \"radius_m\"?");
	begin(&f, "{\"Kind\": 1}");
	cau_read_no_others(&f.reader, f.value, names, 2);
	end(&f, "at.Kind", "unknown: did you mean \"kind\"?");
	begin(&f, "{\"frequency_hz\": 1}");
	cau_read_no_others(&f.reader, f.value, names, 2);
	end(&f, "at.frequency_hz", "unknown");
	begin(&f, "{\"kind\": 1}");
	cau_read_no_others(&f.reader, f.value, names, 2);
	assert_null(cau_value_member(f.value, "KIND"));
	end(&f, NULL, NULL);
}

static void objects_arrays_and_flags(void **state)
{
	(void)state;
	fixture f;
	begin(&f, "[1, 2]");
	assert_false(cau_read_object(&f.reader, f.value));
	end(&f, "at", "an object is needed, not an array of 2");
	begin(&f, "[1, 2]");
	assert_true(cau_read_array(&f.reader, f.value, 0, 2));
	assert_false(cau_read_array(&f.reader, f.value, 0, 1));
	end(&f, "at", "an array of 0 to 1 is needed, not an array of 2");
	begin(&f, "false");
	assert_false(cau_read_bool(&f.reader, f.value));
	end(&f, NULL, NULL);
	begin(&f, "0");
	cau_read_bool(&f.reader, f.value);
	end(&f, "at", "true or false is needed, not 0");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(paths_grow_and_shrink),
		cmocka_unit_test(numbers_say_range_and_unit),
		cmocka_unit_test(integers_are_whole),
		cmocka_unit_test(text_fits_or_fails),
		cmocka_unit_test(names_follow_the_rule),
		cmocka_unit_test(choices_list_and_suggest),
		cmocka_unit_test(rotations_are_checked_and_normalised),
		cmocka_unit_test(unknown_members_are_named),
		cmocka_unit_test(objects_arrays_and_flags),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

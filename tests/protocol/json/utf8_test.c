// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/utf8.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

// Every code point reads back with the length with which it was written.
static void every_code_point_is_valid(void **state)
{
	(void)state;
	for (unsigned code = 0; code <= 0x10FFFF; code++) {
		char text[4];
		if (code >= 0xD800 && code <= 0xDFFF)
			continue;
		size_t length = cau_utf8_encode(code, text);
		assert_int_equal(cau_utf8_length(text, length), length);
		assert_int_equal(cau_utf8_length(text, length - 1), 0);
		for (size_t bytes = 1; bytes < length; bytes++)
			assert_true(cau_utf8_is_start(text, bytes));
		assert_false(cau_utf8_is_start(text, length));
	}
}

static void surrogates_and_beyond_are_not(void **state)
{
	(void)state;
	for (unsigned code = 0xD800; code <= 0xDFFF; code++) {
		char text[4];
		assert_int_equal(cau_utf8_length(text, cau_utf8_encode(code, text)), 0);
		// the second byte already shows that it is invalid
		assert_false(cau_utf8_is_start(text, 2));
	}
	for (unsigned code = 0x110000; code < 0x1FFFFF; code += 0xFFF) {
		char text[4];
		assert_int_equal(cau_utf8_length(text, cau_utf8_encode(code, text)), 0);
	}
}

// Two bytes have 2^16 forms. Of these, 128 x 256 start with an ASCII character, and 30 x 64 are
// characters of two bytes.
static void counts_of_short_forms(void **state)
{
	(void)state;
	int ones = 0, twos = 0;
	for (int i = 0; i < 65536; i++) {
		char text[2] = {(char)(i >> 8), (char)(i & 255)};
		ones += cau_utf8_length(text, 2) == 1;
		twos += cau_utf8_length(text, 2) == 2;
	}
	assert_int_equal(ones, 128 * 256);
	assert_int_equal(twos, 30 * 64);
}

// Characters of two bytes have 30 first bytes, of three bytes 16, of four bytes 5. No other byte
// starts a longer character.
static void a_start_is_a_first_byte_of_a_longer_one(void **state)
{
	(void)state;
	int starts = 0;
	for (int i = 0; i < 256; i++) {
		char text[1] = {(char)i};
		starts += cau_utf8_is_start(text, 1);
	}
	assert_int_equal(starts, 30 + 16 + 5);
}

// The first byte that is not ASCII is at every position, with all kinds of bytes after it.
static void ascii_ends_at_the_first_other_byte(void **state)
{
	(void)state;
	char text[40];
	for (size_t bytes = 0; bytes <= sizeof text; bytes++)
		for (size_t first = 0; first <= bytes; first++) {
			memset(text, 0x7f, sizeof text);
			if (first < sizeof text)
				text[first] = (char)0x80;
			assert_int_equal(cau_utf8_ascii(text, bytes), first);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_code_point_is_valid),
		cmocka_unit_test(surrogates_and_beyond_are_not),
		cmocka_unit_test(counts_of_short_forms),
		cmocka_unit_test(ascii_ends_at_the_first_other_byte),
		cmocka_unit_test(a_start_is_a_first_byte_of_a_longer_one),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

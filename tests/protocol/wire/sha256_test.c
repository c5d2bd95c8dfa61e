// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/sha256.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// The examples of FIPS 180-4.
static void known_digests(void **state)
{
	(void)state;
	char text[CAU_SHA256_TEXT_BYTES];
	assert_true(cau_sha256("", 0, text));
	assert_string_equal(text, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
	assert_true(cau_sha256("abc", 3, text));
	assert_string_equal(text, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(known_digests)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

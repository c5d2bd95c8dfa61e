// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

enum { BYTES = 100, HASHES = BYTES * 8 + BYTES + 1 };

static int compare(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

// All states that differ by one flipped bit, and all shorter lengths, have different hashes.
static void test_every_bit_and_length_counts(void **state)
{
	(void)state;
	unsigned char bytes[BYTES] = {0};
	uint64_t hash[HASHES];
	size_t count = 0;
	for (size_t bit = 0; bit < 8 * BYTES; bit++) {
		bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
		hash[count++] = cau_hash_bytes(CAU_HASH_START, bytes, BYTES);
		bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
	}
	for (size_t length = 0; length <= BYTES; length++)
		hash[count++] = cau_hash_bytes(CAU_HASH_START, bytes, length);
	assert_int_equal(count, HASHES);
	qsort(hash, count, sizeof *hash, compare);
	for (size_t k = 1; k < count; k++)
		assert_true(hash[k] != hash[k - 1]);
}

static void test_order_and_alignment(void **state)
{
	(void)state;
	unsigned char bytes[BYTES + 1];
	for (int i = 0; i <= BYTES; i++)
		bytes[i] = (unsigned char)(7 * i + 1);
	uint64_t whole = cau_hash_bytes(CAU_HASH_START, bytes, BYTES);
	memmove(bytes + 1, bytes, BYTES);
	assert_true(cau_hash_bytes(CAU_HASH_START, bytes + 1, BYTES) == whole);
	uint64_t a = cau_hash_word(cau_hash_word(CAU_HASH_START, 1), 2);
	uint64_t b = cau_hash_word(cau_hash_word(CAU_HASH_START, 2), 1);
	assert_true(a != b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_every_bit_and_length_counts),
		cmocka_unit_test(test_order_and_alignment),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

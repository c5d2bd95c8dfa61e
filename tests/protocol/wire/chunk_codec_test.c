// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/chunk_codec.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void test_round_trip(void **unused)
{
	(void)unused;
	uint8_t bytes[CAU_CHUNK_HEADER_BYTES + 5] = {0};
	cau_chunk sent = {.transfer = 0x01020304, .offset = 0x1122334455667788}, got;
	cau_chunk_header_write(bytes, &sent);
	memcpy(bytes + CAU_CHUNK_HEADER_BYTES, "hello", 5);
	assert_int_equal(cau_chunk_read(bytes, sizeof bytes, &got, NULL), CAU_OK);
	assert_true(got.transfer == sent.transfer && got.offset == sent.offset);
	assert_int_equal(got.byte_count, 5);
	assert_memory_equal(got.data, "hello", 5);
}

static void test_what_is_no_chunk(void **unused)
{
	(void)unused;
	uint8_t *bytes = calloc(1, CAU_CHUNK_HEADER_BYTES + CAU_CHUNK_BYTES_MAX + 1);
	cau_chunk chunk = {0};
	cau_chunk_header_write(bytes, &chunk);
	for (size_t count = 0; count < CAU_CHUNK_HEADER_BYTES; count++)
		assert_int_equal(cau_chunk_read(bytes, count, &chunk, NULL), CAU_CORRUPT);
	assert_int_equal(cau_chunk_read(bytes, CAU_CHUNK_HEADER_BYTES, &chunk, NULL), CAU_LIMIT);
	size_t most = CAU_CHUNK_HEADER_BYTES + CAU_CHUNK_BYTES_MAX;
	assert_int_equal(cau_chunk_read(bytes, most, &chunk, NULL), CAU_OK);
	assert_int_equal(cau_chunk_read(bytes, most + 1, &chunk, NULL), CAU_LIMIT);
	bytes[3] = 'F';
	assert_int_equal(cau_chunk_read(bytes, most, &chunk, NULL), CAU_CORRUPT);
	free(bytes);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_round_trip),
		cmocka_unit_test(test_what_is_no_chunk),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

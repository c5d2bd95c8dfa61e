// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/json_writer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void write_sample(cau_json_writer *writer)
{
	cau_json_open(writer, NULL, '{');
	cau_json_string(writer, "text", "a\"\\\n\t\x01 \xc3\xa9");
	cau_json_number(writer, "half", 0.5);
	cau_json_integer(writer, "whole", -3);
	cau_json_unsigned(writer, "count", 9007199254740991u);
	cau_json_bool(writer, "yes", true);
	cau_json_null(writer, "none");
	cau_json_numbers(writer, "vector", (double[]){1.0, 0.1, -2e-9}, 3);
	cau_json_open(writer, "empty", '[');
	cau_json_close(writer);
	cau_json_open(writer, "list", '[');
	cau_json_open(writer, NULL, '{');
	cau_json_close(writer);
	cau_json_raw(writer, NULL, "[1]", 3);
	cau_json_close(writer);
	cau_json_close(writer);
}

static void writes_on_one_line(void **state)
{
	(void)state;
	char text[512];
	size_t bytes;
	cau_error error;
	cau_json_writer writer;
	cau_json_begin(&writer, text, sizeof text, 0);
	write_sample(&writer);
	assert_int_equal(cau_json_end(&writer, &bytes, &error), CAU_OK);
	assert_string_equal(text, "{\"text\":\"a\\\"\\\\\\n\\t\\u0001 \xc3\xa9\",\"half\":0.5,"
	                          "\"whole\":-3,\"count\":9007199254740991,\"yes\":true,\"none\":null,"
	                          "\"vector\":[1,0.1,-2e-09],\"empty\":[],\"list\":[{},[1]]}");
	assert_int_equal(bytes, strlen(text));
	assert_int_equal(cau_json_scan(text, bytes, sizeof text, &error), CAU_OK);
}

static void writes_indented(void **state)
{
	(void)state;
	char text[256];
	cau_error error;
	cau_json_writer writer;
	cau_json_begin(&writer, text, sizeof text, 2);
	cau_json_open(&writer, NULL, '{');
	cau_json_numbers(&writer, "v", (double[]){1.0, 2.0}, 2);
	cau_json_open(&writer, "list", '[');
	cau_json_integer(&writer, NULL, 1);
	cau_json_integer(&writer, NULL, 2);
	cau_json_close(&writer);
	cau_json_close(&writer);
	assert_int_equal(cau_json_end(&writer, NULL, &error), CAU_OK);
	assert_string_equal(text, "{\n  \"v\": [1, 2],\n  \"list\": [\n    1,\n    2\n  ]\n}");
}

// Tries every capacity that is too small. Nothing is written beyond it, and the needed length is
// reported.
static void a_small_buffer_is_a_limit(void **state)
{
	(void)state;
	char text[512];
	size_t bytes, need;
	cau_error error;
	cau_json_writer writer;
	cau_json_begin(&writer, NULL, 0, 2);
	write_sample(&writer);
	assert_int_equal(cau_json_end(&writer, &need, &error), CAU_LIMIT);
	for (size_t capacity = 1; capacity <= need; capacity++) {
		memset(text, '#', sizeof text);
		cau_json_begin(&writer, text, capacity, 2);
		write_sample(&writer);
		assert_int_equal(cau_json_end(&writer, &bytes, &error), CAU_LIMIT);
		assert_int_equal(bytes, need);
		assert_int_equal(text[capacity - 1], 0);
		assert_int_equal(text[capacity], '#');
	}
	cau_json_begin(&writer, text, need + 1, 2);
	write_sample(&writer);
	assert_int_equal(cau_json_end(&writer, &bytes, &error), CAU_OK);
	assert_int_equal(bytes, strlen(text));
}

static void check_number(double value)
{
	char text[64];
	cau_json_writer writer;
	cau_error error;
	size_t bytes;
	cau_json_begin(&writer, text, sizeof text, 0);
	cau_json_number(&writer, NULL, value);
	assert_int_equal(cau_json_end(&writer, &bytes, &error), CAU_OK);
	assert_int_equal(cau_json_scan(text, bytes, sizeof text, &error), CAU_OK);
	double back = strtod(text, NULL);
	assert_memory_equal(&back, &value, sizeof value);
}

static void numbers_come_back_bit_for_bit(void **state)
{
	(void)state;
	const double hard[] = {0.0,
	                       -0.0,
	                       0.1,
	                       1.0 / 3.0,
	                       1.0 / 60.0,
	                       DBL_MAX,
	                       DBL_MIN,
	                       5e-324,
	                       4.2e-6,
	                       0.3,
	                       1e15,
	                       1e22,
	                       1e23,
	                       9.007199254740993e15,
	                       9007199254740994.0,
	                       -1e300};
	for (size_t i = 0; i < sizeof hard / sizeof *hard; i++)
		check_number(hard[i]);
	uint64_t bits = 88172645463325252u; // xorshift64: random bits of doubles
	for (int i = 0; i < 20000; i++) {
		double value;
		bits ^= bits << 13;
		bits ^= bits >> 7;
		bits ^= bits << 17;
		memcpy(&value, &bits, sizeof value);
		if (isfinite(value))
			check_number(value);
	}
}

static void expect_failure(const cau_json_writer *begun, cau_status status)
{
	cau_json_writer writer = *begun;
	cau_error error;
	assert_int_equal(cau_json_end(&writer, NULL, &error), status);
}

static void refuses_what_json_cannot_say(void **state)
{
	(void)state;
	char text[256];
	cau_json_writer writer;
	for (int kind = 0; kind < 8; kind++) {
		cau_status wanted = kind < 5 ? CAU_BAD_VALUE : CAU_BAD_STATE;
		cau_json_begin(&writer, text, sizeof text, 0);
		cau_json_open(&writer, NULL, '[');
		if (kind == 0)
			cau_json_number(&writer, NULL, (double)NAN);
		else if (kind == 1)
			cau_json_number(&writer, NULL, -(double)INFINITY);
		else if (kind == 2)
			cau_json_integer(&writer, NULL, -(INT64_C(1) << 53));
		else if (kind == 3)
			cau_json_unsigned(&writer, NULL, UINT64_MAX);
		else if (kind == 4)
			cau_json_string(&writer, NULL, "\xff");
		else if (kind == 5)
			cau_json_bool(&writer, "name", true);
		else if (kind == 6)
			cau_json_open(&writer, NULL, '{');
		else
			cau_json_close(&writer);
		cau_json_close(&writer);
		expect_failure(&writer, wanted);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(writes_on_one_line),
		cmocka_unit_test(writes_indented),
		cmocka_unit_test(a_small_buffer_is_a_limit),
		cmocka_unit_test(numbers_come_back_bit_for_bit),
		cmocka_unit_test(refuses_what_json_cannot_say),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

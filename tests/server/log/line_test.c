// SPDX-License-Identifier: GPL-3.0-or-later
// Writes lines with hostile names, as clients might choose them, and reads them back with a strict
// parser.
#include "log/line.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/json_text.h"
#include "line_parser.h"

enum { LINES = 20000, FIELDS = 6, SHORT_VALUE = 60 };

__attribute__((format(printf, 2, 3))) static void print(cau_log_line *line, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	cau_log_line_print(line, format, arguments);
	va_end(arguments);
}

static void assert_line(const cau_log_line *line, const char *expected)
{
	assert_int_equal(line->bytes, strlen(expected));
	assert_memory_equal(line->text, expected, line->bytes);
}

// ---- random values
static uint64_t random_state = 7;

static unsigned random_below(unsigned most)
{
	random_state = random_state * 6364136223846793005u + 1442695040888963407u;
	return (unsigned)(random_state >> 33) % most;
}

// Makes a value, mostly from parts that would break a line or a careless parser.
static size_t random_value(char *value)
{
	static const char *const parts[] = {"\n",
	                                    "\r\n",
	                                    "\"",
	                                    "\\",
	                                    "=",
	                                    " ",
	                                    " event=x",
	                                    "\" event=\"",
	                                    "\t",
	                                    "\x1b[2J",
	                                    "\x7f",
	                                    "\xff",
	                                    "\xc2",
	                                    "\xc2\x85",
	                                    "\xc2\xa0",
	                                    "\xe2\x80\xa8",
	                                    "\xe2\x80",
	                                    "\xed\xa0\x80",
	                                    "\xc0\xaf",
	                                    "\xf4\x90\x80\x80",
	                                    "\xc3\xa9",
	                                    "\xe2\x82\xac",
	                                    "\xf0\x9f\xa6",
	                                    "knee",
	                                    "\\n",
	                                    "\\x41",
	                                    "...",
	                                    "cut=true"};
	size_t bytes = 0;
	for (unsigned left = random_below(6); left > 0; left--) {
		if (random_below(4) == 0) {
			value[bytes++] = (char)random_below(256);
		} else {
			const char *part = parts[random_below(sizeof parts / sizeof *parts)];
			memcpy(value + bytes, part, strlen(part));
			bytes += strlen(part);
		}
	}
	return bytes;
}

static void every_line_reads_back_as_it_was_meant(void **state)
{
	(void)state;
	for (int i = 0; i < LINES; i++) {
		char values[FIELDS][SHORT_VALUE];
		size_t bytes[FIELDS];
		cau_log_line line = {.bytes = 0};
		line_fields fields;
		for (int f = 0; f < FIELDS; f++) {
			bytes[f] = random_value(values[f]);
			cau_log_line_add(&line, "name", 4, values[f], bytes[f], random_below(2));
		}
		assert_true(line_parse(line.text, line.bytes, &fields));
		assert_int_equal(fields.count, FIELDS);
		for (int f = 0; f < FIELDS; f++) {
			assert_int_equal(fields.fields[f].value_bytes, bytes[f]);
			assert_memory_equal(fields.fields[f].value, values[f], bytes[f]);
		}
	}
}

static void a_plain_value_is_bare(void **state)
{
	(void)state;
	cau_log_line line = {.bytes = 0};
	print(&line, "tool=%s count=%d bytes=%llu part=%.3f", "hook-2", -3, 7ull, 0.5);
	assert_line(&line, "tool=hook-2 count=-3 bytes=7 part=0.500");
}

static void quotes_of_the_format_stay(void **state)
{
	(void)state;
	cau_log_line line = {.bytes = 0};
	print(&line, "name=\"%s\" reason=\"%s at %d\" last=%zu", "x", "bad \"y\"", 4, (size_t)9);
	assert_line(&line, "name=\"x\" reason=\"bad \\\"y\\\" at 4\" last=9");
}

static void a_value_that_needs_quotes_gets_them(void **state)
{
	(void)state;
	cau_log_line line = {.bytes = 0};
	print(&line, "a=%s b=%s c=%s d=%.3s", "", "x y", "k=v", "abcdef");
	assert_line(&line, "a=\"\" b=\"x y\" c=\"k=v\" d=abc");
}

static void a_value_over_the_end_of_its_text_is_not_read(void **state)
{
	(void)state;
	const char text[3] = {'a', 'b', 'c'};
	cau_log_line line = {.bytes = 0};
	print(&line, "text=\"%.*s\"", 3, text);
	assert_line(&line, "text=\"abc\"");
}

static void a_long_value_gives_way_and_leaves_the_others(void **state)
{
	(void)state;
	char name[5000];
	line_fields fields;
	for (int odd = 0; odd < 2; odd++) {
		memset(name, odd ? '\n' : 'x', sizeof name - 1);
		name[sizeof name - 1] = 0;
		cau_log_line line = {.bytes = 0};
		print(&line, "name=%s reason=\"%s\"", name, "why");
		assert_true(line_parse(line.text, line.bytes, &fields));
		assert_int_equal(fields.count, 2);
		assert_true(line.bytes < CAU_LOG_VALUE_BYTES + 40);
		size_t kept = fields.fields[0].value_bytes;
		assert_memory_equal(fields.fields[0].value + kept - 3, "...", 3);
		assert_string_equal(fields.fields[1].value, "why");
	}
}

static void a_line_without_room_says_that_it_is_cut(void **state)
{
	(void)state;
	char value[300];
	memset(value, 'y', sizeof value);
	cau_log_line line = {.bytes = 0};
	line_fields fields;
	for (int i = 0; i < 20; i++)
		cau_log_line_add(&line, "name", 4, value, sizeof value, false);
	assert_true(line.bytes < CAU_LOG_LINE_BYTES); // one byte is left for the line feed
	assert_true(line_parse(line.text, line.bytes, &fields));
	assert_string_equal(fields.fields[fields.count - 1].key, "cut");
	for (int i = 0; i + 1 < fields.count; i++)
		assert_int_equal(fields.fields[i].value_bytes, sizeof value);
}

static void in_json_every_line_is_an_object(void **state)
{
	(void)state;
	for (int i = 0; i < LINES; i++) {
		char key[] = "name0", value[SHORT_VALUE];
		cau_log_line line = {.json = true};
		line.bytes = (size_t)snprintf(line.text, sizeof line.text, "{\"head\":0");
		for (int f = 0; f < FIELDS; f++, key[4]++)
			cau_log_line_add(&line, key, 5, value, random_value(value), random_below(2));
		cau_log_line_end(&line);
		assert_int_equal(line.text[line.bytes - 1], '\n');
		assert_null(memchr(line.text, '\n', line.bytes - 1));
		assert_int_equal(cau_json_scan(line.text, line.bytes, sizeof line.text, NULL), CAU_OK);
	}
}

static void in_json_what_is_a_number_says_the_format(void **state)
{
	(void)state;
	cau_log_line line = {.json = true};
	print(&line, "a=%d b=%s c=%.3f d=\"%s at %d\" e=%d%% f=%g g=%02d", -3, "12", 0.5, "x", 4, 5,
	      (double)INFINITY, 7);
	cau_log_line_end(&line);
	assert_line(&line, ",\"a\":-3,\"b\":\"12\",\"c\":0.500,\"d\":\"x at 4\",\"e\":\"5%\","
	                   "\"f\":\"inf\",\"g\":\"07\"}\n");
}

static void in_json_controls_are_escaped_and_no_utf_8_is_replaced(void **state)
{
	(void)state;
	cau_log_line line = {.json = true};
	print(&line, "a=%s", "\"\\\n\x1b\xc2\x85\xe2\x80\xa8\xff\xc3\xa9");
	cau_log_line_end(&line);
	assert_line(&line, ",\"a\":\"\\\"\\\\\\n\\u001b\\u0085\\u2028\\ufffd\xc3\xa9\"}\n");
}

static void in_json_a_line_without_room_is_cut_and_still_an_object(void **state)
{
	(void)state;
	char value[400], key[] = "name0";
	memset(value, 'x', sizeof value);
	// The lengths are such that the line is cut at every possible byte.
	for (size_t bytes = 300; bytes < sizeof value; bytes++) {
		cau_log_line line = {.json = true};
		line.bytes = (size_t)snprintf(line.text, sizeof line.text, "{\"head\":0");
		for (key[4] = '0'; key[4] < '8'; key[4]++)
			cau_log_line_add(&line, key, 5, value, bytes, false);
		cau_log_line_end(&line);
		assert_true(line.bytes <= sizeof line.text);
		assert_int_equal(cau_json_scan(line.text, line.bytes, sizeof line.text, NULL), CAU_OK);
		assert_non_null(memmem(line.text, line.bytes, "\"cut\":true}", 11));
	}
}

static void the_parser_is_strict(void **state)
{
	(void)state;
	static const char *const wrong[] = {"",           "a",          "a=",         "a=b ",
	                                    " a=b",       "a=b  c=d",   "a=\"b",      "a=\"b\"c",
	                                    "a=b\"",      "a=b=c",      "a=\"\n\"",   "a=\"\\q\"",
	                                    "a=\"\\x4\"", "a=\"\xff\"", "a=\xc3\xa9", "a=\"\xc2\x85\""};
	line_fields fields;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
		assert_false(line_parse(wrong[i], strlen(wrong[i]), &fields));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_line_reads_back_as_it_was_meant),
		cmocka_unit_test(a_plain_value_is_bare),
		cmocka_unit_test(quotes_of_the_format_stay),
		cmocka_unit_test(a_value_that_needs_quotes_gets_them),
		cmocka_unit_test(a_value_over_the_end_of_its_text_is_not_read),
		cmocka_unit_test(a_long_value_gives_way_and_leaves_the_others),
		cmocka_unit_test(a_line_without_room_says_that_it_is_cut),
		cmocka_unit_test(in_json_every_line_is_an_object),
		cmocka_unit_test(in_json_what_is_a_number_says_the_format),
		cmocka_unit_test(in_json_controls_are_escaped_and_no_utf_8_is_replaced),
		cmocka_unit_test(in_json_a_line_without_room_is_cut_and_still_an_object),
		cmocka_unit_test(the_parser_is_strict),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

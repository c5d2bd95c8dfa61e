// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/json_text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cjson/cJSON.h>
#include <cmocka.h>

enum { AMPLE = 1 << 20 };

static const char *const accepted[] = {
	"{}",
	" [ ] ",
	"0",
	"-0",
	"-0.0e-0",
	"1e308",
	"1e-999", // underflow to zero is accepted
	"9007199254740991",
	"9007199254740993.0",
	"\"\"",
	"\"\\u00e9 \\ud83d\\ude00 \\\" \\\\ \\/ \\b\\f\\n\\r\\t\"",
	"\"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80 \xed\x9f\xbf \xee\x80\x80 \xf4\x8f\xbf\xbf\"",
	"true",
	"false",
	"null",
	"{\"a\":1,\"b\":{\"a\":1},\"c\":[{\"a\":1},{\"a\":2}],\"A\":2}",
	"[1,[2,[3,[]]],{\"\":{}}]",
	"\t\r\n {\"a\" : [ 1 , 2 ] }\n",
};

static void accepts_what_the_grammar_allows(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof accepted / sizeof *accepted; i++) {
		cau_error error = {0};
		if (cau_json_scan(accepted[i], strlen(accepted[i]), AMPLE, &error) != CAU_OK)
			fail_msg("%s: %s", accepted[i], error.reason);
	}
}

typedef struct refusal {
	const char *text;
	size_t line, column, byte;
	const char *reason; // a part of the reason
} refusal;

static const refusal refused[] = {
	{"", 1, 1, 0, "ends too early"},
	{"{} x", 1, 4, 3, "follows the value"},
	{"{}{}", 1, 3, 2, "follows the value"},
	{"[1,]", 1, 4, 3, "not a JSON value"},
	{"[1 2]", 1, 4, 3, "comma or ]"},
	{"[1}", 1, 3, 2, "comma or ]"},
	{"{\"a\":1]", 1, 7, 6, "comma or }"},
	{"{\"a\":1,}", 1, 8, 7, "name in quotes"},
	{"{a:1}", 1, 2, 1, "name in quotes"},
	{"{\"a\" 1}", 1, 6, 5, "colon"},
	{"{\"a\":}", 1, 6, 5, "not a JSON value"},
	{"[", 1, 2, 1, "ends too early"},
	{"{\"a\":", 1, 6, 5, "ends too early"},
	{"{\"a", 1, 4, 3, "ends too early"},
	{"'a'", 1, 1, 0, "not a JSON value"},
	{"True", 1, 1, 0, "not a JSON value"},
	{"nul", 1, 4, 3, "ends too early"},
	{"nulL", 1, 4, 3, "not a JSON value"},
	{"NaN", 1, 1, 0, "not a JSON value"},
	{"-Infinity", 1, 2, 1, "needs a digit"},
	{"01", 1, 2, 1, "leading zero"},
	{"-01", 1, 3, 2, "leading zero"},
	{"+1", 1, 1, 0, "not a JSON value"},
	{"[1.]", 1, 4, 3, "after its point"},
	{".5", 1, 1, 0, "not a JSON value"},
	{"[1e]", 1, 4, 3, "exponent"},
	{"[1e+]", 1, 5, 4, "exponent"},
	{"0x10", 1, 2, 1, "follows the value"},
	{"[\n  1e999]", 2, 3, 4, "too large for a double"},
	{"-1e999", 1, 1, 0, "too large for a double"},
	{"9007199254740992", 1, 1, 0, "2^53"},
	{"9007199254740993", 1, 1, 0, "2^53"},
	{"-9007199254740993", 1, 1, 0, "2^53"},
	{"\"a\tb\"", 1, 3, 2, "control character"},
	{"\"a\nb\"", 1, 3, 2, "control character"},
	{"\"\\x\"", 1, 3, 2, "unknown escape"},
	{"\"\\u12g4\"", 1, 3, 2, "hexadecimal"},
	{"\"\\u12", 1, 3, 2, "hexadecimal"},
	{"\"\\u0000\"", 1, 3, 2, "u0000"},
	{"\"\\ude00\"", 1, 3, 2, "low surrogate"},
	{"\"\\ud83d\"", 1, 8, 7, "high surrogate"},
	{"\"\\ud83d\\u0041\"", 1, 8, 7, "high surrogate"},
	{"\"\x80\"", 1, 2, 1, "UTF-8"},
	{"\"\xc0\xaf\"", 1, 2, 1, "UTF-8"},         // overlong
	{"\"\xe0\x9f\xbf\"", 1, 2, 1, "UTF-8"},     // overlong
	{"\"\xed\xa0\x80\"", 1, 2, 1, "UTF-8"},     // a surrogate
	{"\"\xf4\x90\x80\x80\"", 1, 2, 1, "UTF-8"}, // beyond U+10FFFF
	{"\"\xe2\x82\"", 1, 2, 1, "UTF-8"},
	{"\xef\xbb\xbf{}", 1, 1, 0, "not a JSON value"}, // byte order mark
	{"{\"a\":1,\n \"a\":2}", 2, 3, 10, "this name twice"},
	{"{\"a\":1,\"\\u0061\":2}", 1, 9, 8, "this name twice"},
	{"{\"\xc3\xa9\":1,\"\\u00E9\":2}", 1, 10, 9, "this name twice"},
	{"{\"\\ud83d\\ude00\":1,\"\xf0\x9f\x98\x80\":2}", 1, 20, 19, "this name twice"},
	{"{\"x\":{\"b\":1},\"y\":1,\"x\":2}", 1, 21, 20, "this name twice"},
	{"/* c */ 1", 1, 1, 0, "not a JSON value"},
};

static void refuses_and_says_where(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
		const refusal *r = &refused[i];
		cau_error error = {0};
		char place[64];
		snprintf(place, sizeof place, "line %zu, column %zu (byte %zu): ", r->line, r->column,
		         r->byte);
		assert_int_equal(cau_json_scan(r->text, strlen(r->text), AMPLE, &error), CAU_BAD_SYNTAX);
		assert_int_equal(error.status, CAU_BAD_SYNTAX);
		if (strncmp(error.reason, place, strlen(place)) != 0 || !strstr(error.reason, r->reason))
			fail_msg("%s: \"%s\" is not \"%s... %s\"", r->text, error.reason, place, r->reason);
	}
}

// A zero byte is refused at any position, because cJSON would take it for the end of the text.
static void refuses_zero_bytes(void **state)
{
	(void)state;
	cau_error error;
	assert_int_equal(cau_json_scan("1\0", 2, AMPLE, &error), CAU_BAD_SYNTAX);
	assert_int_equal(cau_json_scan("\"a\0b\"", 5, AMPLE, &error), CAU_BAD_SYNTAX);
	assert_int_equal(cau_json_scan("\"\\\0\"", 4, AMPLE, &error), CAU_BAD_SYNTAX);
	assert_int_equal(cau_json_scan("1", 1, AMPLE, NULL), CAU_OK);
	assert_int_equal(cau_json_scan("x", 1, AMPLE, NULL), CAU_BAD_SYNTAX);
}

static void caps_depth(void **state)
{
	(void)state;
	char text[2 * CAU_JSON_MAX_DEPTH + 2];
	cau_error error;
	memset(text, '[', CAU_JSON_MAX_DEPTH);
	memset(text + CAU_JSON_MAX_DEPTH, ']', CAU_JSON_MAX_DEPTH);
	assert_int_equal(cau_json_scan(text, 2 * CAU_JSON_MAX_DEPTH, AMPLE, &error), CAU_OK);
	memset(text, '[', CAU_JSON_MAX_DEPTH + 1);
	memset(text + CAU_JSON_MAX_DEPTH + 1, ']', CAU_JSON_MAX_DEPTH + 1);
	assert_int_equal(cau_json_scan(text, sizeof text, AMPLE, &error), CAU_LIMIT);
	assert_non_null(strstr(error.reason, "byte 64"));
}

static size_t object_of(char *text, int member_count)
{
	size_t used = (size_t)sprintf(text, "{");
	for (int i = 0; i < member_count; i++)
		used += (size_t)sprintf(text + used, "%s\"k%d\":%d", i ? "," : "", i, i);
	used += (size_t)sprintf(text + used, "}");
	return used;
}

static void caps_sizes(void **state)
{
	(void)state;
	static char text[1 << 16];
	cau_error error;
	assert_int_equal(cau_json_scan("[1]", 3, 3, &error), CAU_OK);
	assert_int_equal(cau_json_scan("[1]", 3, 2, &error), CAU_LIMIT);
	assert_int_equal(cau_json_scan(text, object_of(text, CAU_JSON_MAX_MEMBERS), AMPLE, &error),
	                 CAU_OK);
	assert_int_equal(cau_json_scan(text, object_of(text, CAU_JSON_MAX_MEMBERS + 1), AMPLE, &error),
	                 CAU_LIMIT);

	memset(text, '1', CAU_JSON_MAX_NUMBER_BYTES + 1);
	text[1] = '.';
	assert_int_equal(cau_json_scan(text, CAU_JSON_MAX_NUMBER_BYTES, AMPLE, &error), CAU_OK);
	assert_int_equal(cau_json_scan(text, CAU_JSON_MAX_NUMBER_BYTES + 1, AMPLE, &error), CAU_LIMIT);

	size_t bytes = (size_t)sprintf(text, "{\"%0*d\":1}", CAU_JSON_MAX_KEY_BYTES, 7);
	assert_int_equal(cau_json_scan(text, bytes, AMPLE, &error), CAU_OK);
	bytes = (size_t)sprintf(text, "{\"%0*d\":1}", CAU_JSON_MAX_KEY_BYTES + 1, 7);
	assert_int_equal(cau_json_scan(text, bytes, AMPLE, &error), CAU_LIMIT);
}

// The limit of names is shared by all nested open objects.
static void caps_open_keys(void **state)
{
	(void)state;
	static char text[1 << 17];
	size_t used = 0;
	cau_error error;
	for (int level = 0; level < 5; level++)
		for (int i = 0; i < 250; i++)
			used +=
				(size_t)sprintf(text + used, "%s\"k%d\":%s", i ? "," : "{", i, i == 249 ? "" : "0");
	used += (size_t)sprintf(text + used, "0}}}}}");
	assert_int_equal(cau_json_scan(text, used, AMPLE, &error), CAU_LIMIT);
	assert_non_null(strstr(error.reason, "1024"));
}

// The strict scan exists because cJSON accepts these texts. If cJSON refuses one of them one day,
// the scan can be simplified.
static void refuses_what_cjson_accepts(void **state)
{
	(void)state;
	static const char *const lax[] = {
		"{} x", "1e999", "01", "1.", "\"a\tb\"", "\"\x80\"", "{\"a\":1,\"a\":2}"};
	for (size_t i = 0; i < sizeof lax / sizeof *lax; i++) {
		cJSON *value = cJSON_Parse(lax[i]);
		if (!value)
			fail_msg("cJSON refuses %s", lax[i]);
		cJSON_Delete(value);
		assert_int_equal(cau_json_scan(lax[i], strlen(lax[i]), AMPLE, NULL), CAU_BAD_SYNTAX);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(accepts_what_the_grammar_allows),
		cmocka_unit_test(refuses_and_says_where),
		cmocka_unit_test(refuses_zero_bytes),
		cmocka_unit_test(caps_depth),
		cmocka_unit_test(caps_sizes),
		cmocka_unit_test(caps_open_keys),
		cmocka_unit_test(refuses_what_cjson_accepts),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

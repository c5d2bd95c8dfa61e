// SPDX-License-Identifier: Apache-2.0
// The strict scan is a pushdown automaton over bytes, without recursion and without allocation.
#include "cautery/json_text.h"

#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/utf8.h"

typedef struct level {
	bool object;
	size_t first_key; // index in `keys` of the object's first key
} level;

typedef struct scanner {
	const char *text;
	size_t bytes;
	size_t at;
	size_t depth;
	level levels[CAU_JSON_MAX_DEPTH];
	size_t key_count;                    // number of keys of all open objects
	size_t keys[CAU_JSON_MAX_OPEN_KEYS]; // position after each key's opening quote
	cau_error *error;
} scanner;

static cau_status fail_at(const scanner *s, size_t at, cau_status status, const char *reason)
{
	size_t line = 1, line_start = 0;
	for (size_t i = 0; i < at && i < s->bytes; i++)
		if (s->text[i] == '\n') {
			line++;
			line_start = i + 1;
		}
	return cau_fail(s->error, status, NULL, "line %zu, column %zu (byte %zu): %s", line,
	                at - line_start + 1, at, reason);
}

static cau_status syntax(const scanner *s, const char *reason)
{
	return fail_at(s, s->at, CAU_BAD_SYNTAX, s->at < s->bytes ? reason : "the text ends too early");
}

static int peek(const scanner *s)
{
	CAU_ASSERT(s->at <= s->bytes, "byte %zu of %zu", s->at, s->bytes);
	return s->at < s->bytes ? (unsigned char)s->text[s->at] : -1;
}

static bool is_digit(int c)
{
	return c >= '0' && c <= '9';
}

static void skip_space(scanner *s)
{
	for (int c = peek(s); c == ' ' || c == '\t' || c == '\n' || c == '\r'; c = peek(s))
		s->at++;
}

// ---- strings --------------------------------------------------------------------------------

// Returns the value of the four hexadecimal digits at `at`, or -1.
static int hex4(const char *text, size_t at, size_t bytes)
{
	int code = 0;
	if (at > bytes || bytes - at < 4)
		return -1;
	for (size_t i = at; i < at + 4; i++) {
		char c = text[i];
		int digit = is_digit(c)            ? c - '0'
		            : c >= 'a' && c <= 'f' ? c - 'a' + 10
		            : c >= 'A' && c <= 'F' ? c - 'A' + 10
		                                   : -1;
		if (digit < 0)
			return -1;
		code = code * 16 + digit;
	}
	return code;
}

// Checks a \u escape and the second half of a surrogate pair, and advances past them. The scanner
// is at the `u`.
static cau_status scan_unicode_escape(scanner *s)
{
	CAU_ASSERT(peek(s) == 'u', "an escape at byte %zu that is none", s->at);
	int code = hex4(s->text, s->at + 1, s->bytes);
	if (code < 0)
		return syntax(s, "\\u needs four hexadecimal digits");
	if (code == 0)
		return syntax(s, "\\u0000 is not allowed in a string");
	if (code >= 0xDC00 && code <= 0xDFFF)
		return syntax(s, "a low surrogate without its high one");
	s->at += 5;
	if (code < 0xD800 || code > 0xDBFF)
		return CAU_OK;
	if (s->bytes - s->at >= 6 && s->text[s->at] == '\\' && s->text[s->at + 1] == 'u') {
		int low = hex4(s->text, s->at + 2, s->bytes);
		if (low >= 0xDC00 && low <= 0xDFFF) {
			s->at += 6;
			return CAU_OK;
		}
	}
	return syntax(s, "a high surrogate without its low one");
}

static cau_status scan_escape(scanner *s)
{
	CAU_ASSERT(peek(s) == '\\', "an escape at byte %zu that is none", s->at);
	s->at++; // skip the backslash
	int c = peek(s);
	if (c == 'u')
		return scan_unicode_escape(s);
	if (c < 0 || !strchr("\"\\/bfnrt", c) || c == 0)
		return syntax(s, "unknown escape sequence in a string");
	s->at++;
	return CAU_OK;
}

// Scans a string from its opening quote and stops after its closing quote.
static cau_status scan_string(scanner *s)
{
	CAU_ASSERT(peek(s) == '"', "a string at byte %zu that is none", s->at);
	for (s->at++;;) {
		int c = peek(s);
		if (c == '"') {
			s->at++;
			return CAU_OK;
		}
		if (c < 0)
			return syntax(s, "");
		if (c < 0x20)
			return syntax(s, "a control character in a string: write it as an escape");
		if (c == '\\') {
			cau_status status = scan_escape(s);
			if (status)
				return status;
			continue;
		}
		size_t length = cau_utf8_length(s->text + s->at, s->bytes - s->at);
		if (length == 0)
			return fail_at(s, s->at, CAU_BAD_SYNTAX, "not UTF-8");
		s->at += length;
	}
}

// Resolves the next character of a scanned string, including escapes, into out[4]. Returns its
// length and advances *at; returns 0 at the closing quote.
static size_t next_character(const scanner *s, size_t *at, char out[4])
{
	CAU_ASSERT(*at < s->bytes, "a character at byte %zu of %zu", *at, s->bytes);
	static const char plain[] = "\"\\/bfnrt", meaning[] = "\"\\/\b\f\n\r\t";
	char c = s->text[*at];
	if (c == '"')
		return 0;
	if (c != '\\') {
		size_t length = cau_utf8_length(s->text + *at, s->bytes - *at);
		memcpy(out, s->text + *at, length);
		*at += length;
		return length;
	}
	if (s->text[*at + 1] != 'u') {
		out[0] = meaning[strchr(plain, s->text[*at + 1]) - plain];
		*at += 2;
		return 1;
	}
	unsigned code = (unsigned)hex4(s->text, *at + 2, s->bytes);
	*at += 6;
	if (code >= 0xD800 && code <= 0xDBFF) {
		unsigned low = (unsigned)hex4(s->text, *at + 2, s->bytes);
		code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
		*at += 6;
	}
	return cau_utf8_encode(code, out);
}

static bool same_key(const scanner *s, size_t a, size_t b)
{
	for (;;) {
		char left[4], right[4];
		size_t left_bytes = next_character(s, &a, left);
		size_t right_bytes = next_character(s, &b, right);
		if (left_bytes != right_bytes || memcmp(left, right, left_bytes) != 0)
			return false;
		if (left_bytes == 0)
			return true;
	}
}

static cau_status scan_key(scanner *s)
{
	CAU_ASSERT(s->depth > 0 && s->levels[s->depth - 1].object,
	           "a name at byte %zu, outside all objects", s->at);
	size_t start = s->at + 1;
	size_t first = s->levels[s->depth - 1].first_key;
	cau_status status = scan_string(s);
	if (status)
		return status;
	if (s->at - 1 - start > CAU_JSON_MAX_KEY_BYTES)
		return fail_at(s, start, CAU_LIMIT, "a name of more than 64 bytes");
	if (s->key_count - first == CAU_JSON_MAX_MEMBERS)
		return fail_at(s, start, CAU_LIMIT, "more than 256 members in an object");
	if (s->key_count == CAU_JSON_MAX_OPEN_KEYS)
		return fail_at(s, start, CAU_LIMIT, "more than 1024 members in open objects");
	for (size_t i = first; i < s->key_count; i++)
		if (same_key(s, s->keys[i], start))
			return fail_at(s, start, CAU_BAD_SYNTAX, "the object has this name twice");
	s->keys[s->key_count++] = start;
	CAU_ASSERT(s->key_count <= CAU_JSON_MAX_OPEN_KEYS, "%zu names of open objects", s->key_count);
	return CAU_OK;
}

// ---- numbers --------------------------------------------------------------------------------

static cau_status scan_digits(scanner *s, const char *reason)
{
	if (!is_digit(peek(s)))
		return syntax(s, reason);
	while (is_digit(peek(s)))
		s->at++;
	return CAU_OK;
}

// Returns the value of a number that fits the grammar. strtod needs the decimal point of the
// locale.
static double number_value(const char *text, size_t bytes)
{
	CAU_ASSERT(bytes > 0 && bytes <= CAU_JSON_MAX_NUMBER_BYTES, "a number of %zu bytes", bytes);
	char copy[CAU_JSON_MAX_NUMBER_BYTES + 1];
	memcpy(copy, text, bytes);
	copy[bytes] = 0;
	char *point = strchr(copy, '.');
	if (point)
		*point = localeconv()->decimal_point[0];
	return strtod(copy, NULL);
}

static cau_status scan_number(scanner *s)
{
	size_t start = s->at;
	bool integer = true;
	cau_status status = CAU_OK;
	if (peek(s) == '-')
		s->at++;
	if (peek(s) == '0') {
		s->at++;
		if (is_digit(peek(s)))
			return syntax(s, "a digit after a leading zero");
	} else {
		status = scan_digits(s, "a number needs a digit here");
	}
	if (!status && peek(s) == '.') {
		integer = false;
		s->at++;
		status = scan_digits(s, "a number needs a digit after its point");
	}
	if (!status && (peek(s) == 'e' || peek(s) == 'E')) {
		integer = false;
		s->at++;
		if (peek(s) == '+' || peek(s) == '-')
			s->at++;
		status = scan_digits(s, "a number needs a digit in its exponent");
	}
	if (status)
		return status;
	if (s->at - start > CAU_JSON_MAX_NUMBER_BYTES)
		return fail_at(s, start, CAU_LIMIT, "a number of more than 63 characters");
	double value = number_value(s->text + start, s->at - start);
	if (!isfinite(value))
		return fail_at(s, start, CAU_BAD_SYNTAX, "a number too large for a double (above 1.8e308)");
	// 2^53 + 1 rounds to 2^53, so the bound itself is ambiguous as well.
	if (integer && fabs(value) >= 9007199254740992.0)
		return fail_at(s, start, CAU_BAD_SYNTAX, "an integer of 2^53 or more, which readers round");
	return CAU_OK;
}

// ---- structure ------------------------------------------------------------------------------

static cau_status scan_word(scanner *s, const char *word)
{
	for (; *word; word++, s->at++)
		if (peek(s) != *word)
			return syntax(s, "not a JSON value");
	return CAU_OK;
}

static cau_status open_level(scanner *s)
{
	CAU_ASSERT(s->depth <= CAU_JSON_MAX_DEPTH, "%zu levels", s->depth);
	if (s->depth == CAU_JSON_MAX_DEPTH)
		return fail_at(s, s->at, CAU_LIMIT, "more than 64 levels of arrays and objects");
	s->levels[s->depth++] = (level){.object = peek(s) == '{', .first_key = s->key_count};
	s->at++;
	return CAU_OK;
}

static void close_level(scanner *s)
{
	CAU_ASSERT(s->depth > 0, "a level is closed that is not open, at byte %zu", s->at);
	s->key_count = s->levels[--s->depth].first_key;
	CAU_ASSERT(s->key_count <= CAU_JSON_MAX_OPEN_KEYS, "%zu names of open objects", s->key_count);
	s->at++;
}

// Scans a name and its colon.
static cau_status scan_member_start(scanner *s)
{
	skip_space(s);
	if (peek(s) != '"')
		return syntax(s, "a name in quotes is needed here");
	cau_status status = scan_key(s);
	if (status)
		return status;
	skip_space(s);
	if (peek(s) != ':')
		return syntax(s, "a colon is needed here");
	s->at++;
	return CAU_OK;
}

// Continues after a value: closes levels, then stops before the next value or at the end (*done).
static cau_status scan_after_value(scanner *s, bool *done)
{
	for (;;) {
		skip_space(s);
		if (s->depth == 0) {
			*done = true;
			return s->at == s->bytes ? CAU_OK : syntax(s, "more text follows the value");
		}
		bool object = s->levels[s->depth - 1].object;
		if (peek(s) == ',') {
			s->at++;
			return object ? scan_member_start(s) : CAU_OK;
		}
		if (peek(s) != (object ? '}' : ']'))
			return syntax(s,
			              object ? "a comma or } is needed here" : "a comma or ] is needed here");
		close_level(s);
	}
}

// Opens the array or object at the present position. *value is true if a first value follows, and
// false if it is empty.
static cau_status scan_opening(scanner *s, bool *value)
{
	cau_status status = open_level(s);
	if (status)
		return status;
	bool object = s->levels[s->depth - 1].object;
	skip_space(s);
	*value = peek(s) != (object ? '}' : ']');
	if (!*value)
		close_level(s);
	else if (object)
		return scan_member_start(s);
	return CAU_OK;
}

static cau_status scan_scalar(scanner *s)
{
	int c = peek(s);
	if (c == '"')
		return scan_string(s);
	if (c == '-' || is_digit(c))
		return scan_number(s);
	if (c == 't')
		return scan_word(s, "true");
	if (c == 'f')
		return scan_word(s, "false");
	if (c == 'n')
		return scan_word(s, "null");
	return syntax(s, "not a JSON value");
}

cau_status cau_json_scan(const char *text, size_t bytes, size_t bytes_max, cau_error *error)
{
	CAU_ASSERT(text || !bytes, "%zu bytes that are nowhere", bytes);
	scanner s = {.text = text, .bytes = bytes, .error = error};
	if (bytes > bytes_max)
		return cau_fail(error, CAU_LIMIT, NULL, "%zu bytes, the limit is %zu", bytes, bytes_max);
	for (bool done = false; !done;) {
		skip_space(&s);
		bool value_follows = false;
		cau_status status =
			peek(&s) == '{' || peek(&s) == '[' ? scan_opening(&s, &value_follows) : scan_scalar(&s);
		if (!status && !value_follows)
			status = scan_after_value(&s, &done);
		if (status)
			return status;
	}
	return CAU_OK;
}

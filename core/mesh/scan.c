// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/scan.h"

#include <errno.h>
#include <locale.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cautery/assert.h"

enum {
	NUMBER_BYTES = 64, // most bytes of a number as text, with the terminating zero
	QUOTE_BYTES = 32,  // most bytes of a word in a message, with the terminating zero
};

cau_scan cau_scan_make(const void *bytes, size_t byte_count, cau_error *error)
{
	CAU_ASSERT(bytes || !byte_count, "%zu bytes that are nowhere", byte_count);
	return (cau_scan){.bytes = bytes, .count = byte_count, .error = error};
}

static size_t line_of(const cau_scan *scan, size_t at)
{
	CAU_ASSERT(at <= scan->count, "byte %zu of %zu", at, scan->count);
	size_t line = 1;
	for (size_t i = 0; i < at; i++)
		line += scan->bytes[i] == '\n';
	return line;
}

void cau_scan_fail(cau_scan *scan, cau_status status, const char *format, ...)
{
	CAU_ASSERT(status != CAU_OK, "a failure that is none: %s", format);
	if (scan->status)
		return;
	char reason[240];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(reason, sizeof reason, format, arguments);
	va_end(arguments);
	if (scan->binary)
		scan->status = cau_fail(scan->error, status, NULL, "byte %zu: %s", scan->mark, reason);
	else
		scan->status =
			cau_fail(scan->error, status, NULL, "line %zu: %s", line_of(scan, scan->mark), reason);
}

// Returns the first bytes of a word for a message. Bytes that cannot be printed become '?'.
static const char *quote(cau_word word, char text[static QUOTE_BYTES])
{
	size_t length = word.length < QUOTE_BYTES - 1 ? word.length : QUOTE_BYTES - 1;
	for (size_t i = 0; i < length; i++)
		text[i] = (char)(word.text[i] > ' ' && word.text[i] <= '~' ? word.text[i] : '?');
	text[length] = 0;
	return text;
}

static void fail_word(cau_scan *scan, const char *what, cau_word word)
{
	char text[QUOTE_BYTES];
	if (word.length)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected %s, found '%s'", what, quote(word, text));
	else
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected %s, found nothing", what);
}

static bool is_blank(unsigned char byte)
{
	return byte == ' ' || (byte >= '\t' && byte <= '\r');
}

// Returns the length of a backslash with the end of line after it, or 0.
static size_t joint_length(const cau_scan *scan, size_t at)
{
	CAU_ASSERT(at <= scan->count, "byte %zu of %zu", at, scan->count);
	const unsigned char *byte = scan->bytes + at;
	size_t left = scan->count - at;
	if (left >= 2 && byte[0] == '\\' && byte[1] == '\n')
		return 2;
	return left >= 3 && byte[0] == '\\' && byte[1] == '\r' && byte[2] == '\n' ? 3 : 0;
}

static cau_word take_word(cau_scan *scan)
{
	CAU_ASSERT(scan->at < scan->count, "a word at byte %zu of %zu", scan->at, scan->count);
	scan->mark = scan->at;
	while (scan->at < scan->count && !is_blank(scan->bytes[scan->at]) &&
	       !joint_length(scan, scan->at))
		scan->at++;
	return (cau_word){(const char *)scan->bytes + scan->mark, scan->at - scan->mark};
}

cau_word cau_scan_word_of_line(cau_scan *scan)
{
	CAU_ASSERT(scan->at <= scan->count, "byte %zu of %zu", scan->at, scan->count);
	scan->mark = scan->at;
	if (scan->status)
		return (cau_word){0};
	while (scan->at < scan->count && scan->bytes[scan->at] != '\n') {
		size_t joint = joint_length(scan, scan->at);
		if (!joint && !is_blank(scan->bytes[scan->at]))
			return take_word(scan);
		scan->at += joint ? joint : 1;
	}
	return (cau_word){0};
}

cau_word cau_scan_word(cau_scan *scan)
{
	scan->mark = scan->at;
	if (scan->status)
		return (cau_word){0};
	while (scan->at < scan->count && is_blank(scan->bytes[scan->at]))
		scan->at++;
	return scan->at < scan->count ? take_word(scan) : (cau_word){0};
}

cau_word cau_scan_peek(cau_scan *scan)
{
	size_t at = scan->at, mark = scan->mark;
	cau_word word = cau_scan_word(scan);
	scan->at = at;
	scan->mark = mark;
	return word;
}

void cau_scan_skip_line(cau_scan *scan)
{
	CAU_ASSERT(scan->at <= scan->count, "byte %zu of %zu", scan->at, scan->count);
	if (scan->at == scan->count)
		return;
	const unsigned char *from = scan->bytes + scan->at;
	const unsigned char *end = memchr(from, '\n', cau_scan_left(scan));
	scan->at = end ? scan->at + (size_t)(end - from) + 1 : scan->count;
}

bool cau_word_is(cau_word word, const char *text)
{
	return word.length == strlen(text) && !strncasecmp(word.text, text, word.length);
}

void cau_scan_expect(cau_scan *scan, const char *text)
{
	cau_word word = cau_scan_word(scan);
	if (!scan->status && !cau_word_is(word, text))
		fail_word(scan, text, word);
}

// Copies a word that may be a number. Returns false if the word is empty or too long.
static bool copy_number(cau_word word, char text[static NUMBER_BYTES])
{
	if (word.length == 0 || word.length >= NUMBER_BYTES)
		return false;
	memcpy(text, word.text, word.length);
	text[word.length] = 0;
	return true;
}

int64_t cau_scan_word_integer(cau_scan *scan, cau_word word, const char *what, int64_t least,
                              int64_t most)
{
	CAU_ASSERT(least <= most, "%s from %lld to %lld", what, (long long)least, (long long)most);
	if (scan->status)
		return 0;
	char text[NUMBER_BYTES], *end = NULL;
	long long value = 0;
	bool is_number = copy_number(word, text);
	if (is_number) {
		errno = 0;
		value = strtoll(text, &end, 10);
		is_number = end != text && *end == 0 && errno == 0;
	}
	if (!is_number)
		fail_word(scan, what, word);
	else if (value < least || value > most)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected %s, but found %s, which is not valid", what,
		              text);
	return scan->status ? 0 : value;
}

int64_t cau_scan_text_integer(cau_scan *scan, const char *what, int64_t least, int64_t most)
{
	return cau_scan_word_integer(scan, cau_scan_word(scan), what, least, most);
}

double cau_scan_word_real(cau_scan *scan, cau_word word, const char *what)
{
	if (scan->status)
		return 0;
	char text[NUMBER_BYTES], *end = NULL;
	if (copy_number(word, text)) {
		// the C locale is static in the C library, so newlocale allocates nothing
		double value = strtod_l(text, &end, newlocale(LC_ALL_MASK, "C", (locale_t)0));
		if (end != text && *end == 0)
			return value;
	}
	fail_word(scan, what, word);
	return 0;
}

// Copies a binary number into native byte order. Returns false if the bytes have ended.
static bool take_bytes(cau_scan *scan, const char *what, unsigned char *out, int bytes)
{
	CAU_ASSERT(bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8, "%s of %d bytes", what, bytes);
	scan->mark = scan->at;
	CAU_ASSERT(scan->at <= scan->count, "byte %zu of %zu", scan->at, scan->count);
	if (scan->status)
		return false;
	if (cau_scan_left(scan) < (size_t)bytes) {
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected %s, but the file ends", what);
		return false;
	}
	for (int i = 0; i < bytes; i++)
		out[scan->swap ? bytes - 1 - i : i] = scan->bytes[scan->at + (size_t)i];
	scan->at += (size_t)bytes;
	return true;
}

int64_t cau_scan_integer(cau_scan *scan, const char *what, int bytes, int64_t least, int64_t most)
{
	if (!scan->binary)
		return cau_scan_text_integer(scan, what, least, most);
	union {
		unsigned char raw[8];
		int8_t i1;
		int16_t i2;
		int32_t i4;
		int64_t i8;
	} number = {0};
	if (!take_bytes(scan, what, number.raw, bytes))
		return 0;
	int64_t value = bytes == 1   ? number.i1
	                : bytes == 2 ? number.i2
	                : bytes == 4 ? number.i4
	                             : number.i8;
	if (value < least || value > most) {
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "expected %s, but found %lld, which is not valid", what,
		              (long long)value);
		return 0;
	}
	return value;
}

double cau_scan_real(cau_scan *scan, const char *what, int bytes)
{
	if (!scan->binary)
		return cau_scan_word_real(scan, cau_scan_word(scan), what);
	union {
		unsigned char raw[8];
		float f4;
		double f8;
	} number = {0};
	if (!take_bytes(scan, what, number.raw, bytes))
		return 0;
	return bytes == 4 ? (double)number.f4 : number.f8;
}

void cau_scan_check_count(cau_scan *scan, const char *what, int64_t count, int64_t item_bytes)
{
	CAU_ASSERT(item_bytes > 0, "%s of %lld bytes each", what, (long long)item_bytes);
	if (scan->status)
		return;
	if ((uint64_t)count > cau_scan_left(scan) / (size_t)item_bytes)
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "%lld as %s is not possible: only %zu bytes follow",
		              (long long)count, what, cau_scan_left(scan));
}

int64_t cau_scan_count(cau_scan *scan, const char *what, int64_t item_bytes)
{
	int64_t count = cau_scan_text_integer(scan, what, 0, INT64_MAX);
	cau_scan_check_count(scan, what, count, item_bytes);
	return scan->status ? 0 : count;
}

void cau_scan_skip(cau_scan *scan, int64_t byte_count)
{
	scan->mark = scan->at;
	if (scan->status)
		return;
	if (byte_count < 0 || (uint64_t)byte_count > cau_scan_left(scan))
		cau_scan_fail(scan, CAU_BAD_SYNTAX, "the file ends too early");
	else
		scan->at += (size_t)byte_count;
}

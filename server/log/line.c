// SPDX-License-Identifier: GPL-3.0-or-later
#include "log/line.h"

#include <assert.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/utf8.h"

enum {
	ESCAPE_BYTES = 16, // longest escaped character: four bytes, \xHH each
	SPEC_BYTES = 16,
	RAW_BYTES = 512, // longest value before escapes; CAU_LOG_VALUE_BYTES cuts it anyway
};

static const char cut_mark[] = " cut=true", cut_member[] = ",\"cut\":true", more_mark[] = "...";

// ---- escapes
static bool is_bare(unsigned char byte)
{
	return byte > 0x20 && byte < 0x7f && !strchr("\"=\\", byte);
}

// True for characters that break lines in some readers, or hide the following text: C0, DEL, C1,
// and the line and paragraph separators U+2028 and U+2029.
static bool is_control(const unsigned char *at, size_t length)
{
	if (length == 1)
		return at[0] < 0x20 || at[0] == 0x7f;
	return (length == 2 && at[0] == 0xC2 && at[1] < 0xA0) ||
	       (length == 3 && at[0] == 0xE2 && at[1] == 0x80 && (at[2] == 0xA8 || at[2] == 0xA9));
}

static size_t short_escape(char byte, char to[ESCAPE_BYTES])
{
	static const char plain[] = "\"\\\n\r\t", escaped[] = "\"\\nrt";
	const char *found = byte ? strchr(plain, byte) : NULL;
	if (!found)
		return 0;
	to[0] = '\\';
	to[1] = escaped[found - plain];
	return 2;
}

// Writes the character at `text` in the form that it has between quotes. *taken: its bytes in
// `text`.
static size_t escape(const char *text, size_t bytes, char to[ESCAPE_BYTES], size_t *taken)
{
	size_t length = cau_utf8_length(text, bytes), written = 0;
	*taken = length ? length : 1;
	size_t mark = short_escape(*text, to);
	if (mark)
		return mark;
	if (length && !is_control((const unsigned char *)text, length)) {
		memcpy(to, text, length);
		return length;
	}
	for (size_t i = 0; i < *taken; i++)
		written += (size_t)snprintf(to + written, ESCAPE_BYTES + 1 - written, "\\x%02x",
		                            (unsigned)(unsigned char)text[i]);
	return written;
}

// Returns the code point of a character of one to three bytes; all characters of is_control() are
// so short.
static unsigned character(const unsigned char *at, size_t length)
{
	switch (length) {
	case 1:
		return at[0];
	case 2:
		return (at[0] & 0x1Fu) << 6 | (at[1] & 0x3Fu);
	default:
		return (at[0] & 0x0Fu) << 12 | (at[1] & 0x3Fu) << 6 | (at[2] & 0x3Fu);
	}
}

// Writes the character at `text` in JSON's form. *taken: its bytes in `text`.
static size_t escape_json(const char *text, size_t bytes, char to[ESCAPE_BYTES], size_t *taken)
{
	const unsigned char *at = (const unsigned char *)text;
	size_t length = cau_utf8_length(text, bytes);
	*taken = length ? length : 1;
	size_t mark = short_escape(*text, to);
	if (mark)
		return mark;
	if (length && !is_control(at, length)) {
		memcpy(to, text, length);
		return length;
	}
	unsigned number = length ? character(at, length) : 0;
	return (size_t)snprintf(to, ESCAPE_BYTES, "\\u%04x", number ? number : 0xFFFDu);
}

static size_t quote(const char *value, size_t bytes, bool json, char to[CAU_LOG_VALUE_BYTES])
{
	size_t length = 0, taken;
	to[length++] = '"';
	for (size_t i = 0; i < bytes; i += taken) {
		char unit[ESCAPE_BYTES + 1];
		size_t unit_bytes = (json ? escape_json : escape)(value + i, bytes - i, unit, &taken);
		if (length + unit_bytes + sizeof more_mark > CAU_LOG_VALUE_BYTES) {
			memcpy(to + length, more_mark, sizeof more_mark - 1);
			length += sizeof more_mark - 1;
			break;
		}
		memcpy(to + length, unit, unit_bytes);
		length += unit_bytes;
	}
	to[length++] = '"';
	return length;
}

// ---- fields
static void append(cau_log_line *line, const char *text, size_t bytes)
{
	assert(bytes <= sizeof line->text - line->bytes);
	memcpy(line->text + line->bytes, text, bytes);
	line->bytes += bytes;
}

// True if `needed` bytes fit. Space for the mark of a cut line and for the line's end is always
// kept.
static bool has_room(cau_log_line *line, size_t needed)
{
	size_t mark_bytes = line->json ? sizeof cut_member : sizeof cut_mark;
	if (line->full)
		return false;
	line->full = needed + mark_bytes + 1 > sizeof line->text - line->bytes;
	if (line->full)
		append(line, line->json ? cut_member : cut_mark, mark_bytes - 1);
	return !line->full;
}

// Adds a JSON member. A `number` is written without quotes.
static void add_member(cau_log_line *line, const char *key, size_t key_bytes, const char *value,
                       size_t value_bytes, bool number)
{
	char written[CAU_LOG_VALUE_BYTES];
	size_t bytes = number ? value_bytes : quote(value, value_bytes, true, written);
	if (!has_room(line, bytes + key_bytes + sizeof ",\"\":" - 1))
		return;
	append(line, ",\"", 2);
	append(line, key, key_bytes);
	append(line, "\":", 2);
	append(line, number ? value : written, bytes);
}

static void add_field(cau_log_line *line, const char *key, size_t key_bytes, const char *value,
                      size_t value_bytes, bool quoted)
{
	char written[CAU_LOG_VALUE_BYTES];
	size_t bare = 0;
	while (bare < value_bytes && is_bare((unsigned char)value[bare]))
		bare++;
	if (bare < value_bytes || value_bytes == 0 || value_bytes > sizeof written)
		quoted = true;
	size_t bytes = quoted ? quote(value, value_bytes, false, written) : value_bytes;
	if (!has_room(line, 1 + key_bytes + 1 + bytes))
		return;
	append(line, line->bytes ? " " : "", line->bytes > 0);
	append(line, key, key_bytes);
	append(line, "=", 1);
	append(line, quoted ? written : value, bytes);
}

void cau_log_line_add(cau_log_line *line, const char *key, size_t key_bytes, const char *value,
                      size_t value_bytes, bool quoted)
{
	if (line->json)
		add_member(line, key, key_bytes, value, value_bytes, false);
	else
		add_field(line, key, key_bytes, value, value_bytes, quoted);
}

void cau_log_line_end(cau_log_line *line)
{
	if (line->json)
		append(line, "}", 1);
	append(line, "\n", 1);
}

// ---- formats
typedef struct raw_value {
	char text[RAW_BYTES];
	size_t bytes;
	int numbers; // number of values printed by %d, %f and similar conversions
	size_t number_bytes;
} raw_value;

static void append_raw(raw_value *value, const char *text, size_t bytes)
{
	size_t room = sizeof value->text - value->bytes;
	memcpy(value->text + value->bytes, text, bytes < room ? bytes : room);
	value->bytes += bytes < room ? bytes : room;
}

// A va_list that functions can pass on and continue to use.
typedef struct arguments {
	va_list list;
} arguments;

static void print_text(raw_value *value, const char *spec, size_t spec_bytes, arguments *from)
{
	size_t most = RAW_BYTES;
	if (spec_bytes > 2 && spec[1] == '.') // a precision: %.*s or %.60s
		most =
			spec[2] == '*' ? (size_t)va_arg(from->list, int) : (size_t)strtoul(spec + 2, NULL, 10);
	const char *text = va_arg(from->list, const char *);
	if (text)
		append_raw(value, text, strnlen(text, most < RAW_BYTES ? most : RAW_BYTES));
}

static void print_number(raw_value *value, const char *spec, size_t spec_bytes, arguments *from)
{
	char own[SPEC_BYTES], text[64];
	int length = 0;
	assert(spec_bytes < sizeof own);
	memcpy(own, spec, spec_bytes);
	own[spec_bytes] = 0;
	if (strchr("feg", own[spec_bytes - 1])) // each branch reads another type from the list
		// NOLINTNEXTLINE(bugprone-branch-clone)
		length = snprintf(text, sizeof text, own, va_arg(from->list, double));
	else if (strstr(own, "ll"))
		length = snprintf(text, sizeof text, own, va_arg(from->list, long long));
	else if (strpbrk(own, "lz")) // long and size_t are equally wide here
		length = snprintf(text, sizeof text, own, va_arg(from->list, long));
	else
		length = snprintf(text, sizeof text, own, va_arg(from->list, int));
	size_t bytes = length < 0 ? 0 : strnlen(text, (size_t)length);
	append_raw(value, text, bytes);
	if (!strchr("xc", own[spec_bytes - 1])) {
		value->numbers++;
		value->number_bytes = bytes;
	}
}

// Prints the conversion at `format` and returns the position behind it.
static const char *print_one(raw_value *value, const char *format, arguments *from)
{
	size_t bytes = 1 + strspn(format + 1, "0123456789.*lz+-#") + 1;
	char kind = format[bytes - 1];
	assert(kind && strchr("sdiuxcfeg%", kind));
	if (kind == '%')
		append_raw(value, "%", 1);
	else if (kind == 's')
		print_text(value, format, bytes, from);
	else
		print_number(value, format, bytes, from);
	return format + bytes;
}

// True if a value is a number in JSON: the format printed only one number, and JSON can write it
// (JSON has no infinities). Readers of JSON keep 15 digits, so longer numbers are strings.
static bool is_number(const raw_value *value)
{
	enum { DIGITS_MOST = 15 };
	const char *text = value->text;
	if (value->numbers != 1 || value->bytes != value->number_bytes || value->bytes > DIGITS_MOST)
		return false;
	for (size_t i = 0; i < value->bytes; i++)
		if (!text[i] || !strchr("0123456789.e+-", text[i]))
			return false;
	size_t sign = value->bytes && *text == '-';
	bool padded = value->bytes > sign + 1 && text[sign] == '0' && text[sign + 1] != '.';
	return value->bytes > sign && text[sign] != '+' && !padded;
}

void cau_log_line_print(cau_log_line *line, const char *format, va_list list)
{
	arguments from;
	va_copy(from.list, list);
	while (*(format += strspn(format, " "))) {
		raw_value value = {.bytes = 0};
		const char *key = format;
		size_t key_bytes = strcspn(format, "=");
		assert(format[key_bytes]);
		format += key_bytes + 1;
		bool quoted = *format == '"';
		format += quoted;
		while (*format && *format != (quoted ? '"' : ' ')) {
			if (*format == '%')
				format = print_one(&value, format, &from);
			else
				append_raw(&value, format++, 1);
		}
		format += *format == '"';
		if (line->json && is_number(&value))
			add_member(line, key, key_bytes, value.text, value.bytes, true);
		else
			cau_log_line_add(line, key, key_bytes, value.text, value.bytes, quoted);
	}
	va_end(from.list);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "log/line.h"

#include <assert.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/utf8.h"

enum {
	ESCAPE_BYTES = 16, // of the longest unit: four bytes, \xHH each
	SPEC_BYTES = 16,
	RAW_BYTES = 512, // of a value before escapes; CAU_LOG_VALUE_BYTES cuts it anyway
};

static const char cut_mark[] = " cut=true", more_mark[] = "...";

// ---- escapes
static bool is_bare(unsigned char byte)
{
	return byte > 0x20 && byte < 0x7f && !strchr("\"=\\", byte);
}

// What breaks lines in some reader, or hides what follows: C0, DEL, C1, and the separators of lines
// and paragraphs, U+2028 and U+2029.
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

// Writes the character at `text` as it stands between quotes; *taken is its length.
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

static size_t quote(const char *value, size_t bytes, char to[CAU_LOG_VALUE_BYTES])
{
	size_t length = 0, taken;
	to[length++] = '"';
	for (size_t i = 0; i < bytes; i += taken) {
		char unit[ESCAPE_BYTES + 1];
		size_t unit_bytes = escape(value + i, bytes - i, unit, &taken);
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

void cau_log_line_add(cau_log_line *line, const char *key, size_t key_bytes, const char *value,
                      size_t value_bytes, bool quoted)
{
	char written[CAU_LOG_VALUE_BYTES];
	size_t bare = 0;
	while (bare < value_bytes && is_bare((unsigned char)value[bare]))
		bare++;
	if (bare < value_bytes || value_bytes == 0 || value_bytes > sizeof written)
		quoted = true;
	size_t bytes = quoted ? quote(value, value_bytes, written) : value_bytes;
	size_t needed = 1 + key_bytes + 1 + bytes;
	if (line->full)
		return;
	// Room for the mark and the line's end is always kept.
	line->full = needed + sizeof cut_mark > sizeof line->text - line->bytes;
	if (line->full) {
		append(line, cut_mark, sizeof cut_mark - 1);
		return;
	}
	append(line, line->bytes ? " " : "", line->bytes > 0);
	append(line, key, key_bytes);
	append(line, "=", 1);
	append(line, quoted ? written : value, bytes);
}

// ---- formats
typedef struct raw_value {
	char text[RAW_BYTES];
	size_t bytes;
} raw_value;

static void append_raw(raw_value *value, const char *text, size_t bytes)
{
	size_t room = sizeof value->text - value->bytes;
	memcpy(value->text + value->bytes, text, bytes < room ? bytes : room);
	value->bytes += bytes < room ? bytes : room;
}

// A va_list that functions can hand on and go on with.
typedef struct arguments {
	va_list list;
} arguments;

static void print_text(raw_value *value, const char *spec, size_t spec_bytes, arguments *from)
{
	size_t most = RAW_BYTES;
	if (spec_bytes > 2 && spec[1] == '.') // %.*s or %.60s
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
	if (strchr("feg", own[spec_bytes - 1])) // each takes another type off the list
		// NOLINTNEXTLINE(bugprone-branch-clone)
		length = snprintf(text, sizeof text, own, va_arg(from->list, double));
	else if (strstr(own, "ll"))
		length = snprintf(text, sizeof text, own, va_arg(from->list, long long));
	else if (strpbrk(own, "lz")) // both are as wide here
		length = snprintf(text, sizeof text, own, va_arg(from->list, long));
	else
		length = snprintf(text, sizeof text, own, va_arg(from->list, int));
	append_raw(value, text, length < 0 ? 0 : strnlen(text, (size_t)length));
}

// Prints the conversion at `format` and returns what follows it.
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
		cau_log_line_add(line, key, key_bytes, value.text, value.bytes, quoted);
	}
	va_end(from.list);
}

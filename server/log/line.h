// SPDX-License-Identifier: GPL-3.0-or-later
// The fields of a log line: `key=value` with one space between two, or the members of a JSON
// object.
//
// In text, a value is in quotes if the format has quotes, if it is empty, or if it contains
// anything but printable ASCII without space, `"`, `=` and `\`. Otherwise it has no quotes. Within
// quotes `"` and `\` get a `\` before them; line feed, return and tab are \n, \r and \t. Other
// control characters, the line separators of Unicode, and bytes that are not UTF-8 are \x and two
// hex digits for each byte. So whatever a client sends, a line stays one line and its fields stay
// apart.
//
// In JSON a value is a number if the format prints only one number (%d, %f), else a string. Control
// characters and line separators are escaped; zeros and bytes that are not UTF-8 become U+FFFD.
#pragma once

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

enum {
	CAU_LOG_LINE_BYTES = 2048, // below PIPE_BUF, so that one write arrives as one line in a pipe
	// longest value, with quotes and escapes; a longer one is cut and ends with ...
	CAU_LOG_VALUE_BYTES = 480,
};

typedef struct cau_log_line {
	char text[CAU_LOG_LINE_BYTES]; // without a zero at the end
	size_t bytes;
	bool full; // a field did not fit; the line says so with `cut=true`
	// set before the first field; the caller writes the line's beginning up to the first member
	bool json;
} cau_log_line;

// Adds one field. A key is a word of the program, not from outside.
void cau_log_line_add(cau_log_line *line, const char *key, size_t key_bytes, const char *value,
                      size_t value_bytes, bool quoted);

// Adds fields in the way of printf: `tool=%s reason="%s at %d"`. A value ends at a space or, in
// quotes, at the closing quote. Knows %s (also with a precision), %d %i %u %x %c with their length
// modifiers, and %f %g %e.
void cau_log_line_print(cau_log_line *line, const char *format, va_list arguments);

// Ends the line with a line feed; in JSON, closes the object first.
void cau_log_line_end(cau_log_line *line);

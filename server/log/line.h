// SPDX-License-Identifier: GPL-3.0-or-later
// The fields of a log line: `key=value`, one space between two; or the members of a JSON object.
//
// A value is bare, or in quotes: where the format says so, and whenever it is empty or holds
// anything but printable ASCII without space, `"`, `=` and `\`. In quotes `"` and `\` get a `\`
// before them; line feed, return and tab are \n, \r and \t; other control characters, the line
// separators of Unicode, and bytes that are no UTF-8 are \x and two hex digits for each byte. So
// whatever a client sends, a line stays one line and its fields stay its fields.
//
// In JSON a value is a number where the format prints nothing but one (%d, %f), else a string;
// control characters and the separators of lines are escaped, and zeros and bytes that are no UTF-8
// become U+FFFD.
#pragma once

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

enum {
	CAU_LOG_LINE_BYTES = 2048, // below PIPE_BUF: one write is one line for whoever reads the pipe
	CAU_LOG_VALUE_BYTES = 480, // of a value, quotes and escapes included; the rest gives way to ...
};

typedef struct cau_log_line {
	char text[CAU_LOG_LINE_BYTES]; // without a zero at its end
	size_t bytes;
	bool full; // a field had no room; the line tells it with `cut=true`
	bool json; // set before the first field; the head, up to the first member, is the caller's
} cau_log_line;

// Adds one field. A key is a word of the program's own.
void cau_log_line_add(cau_log_line *line, const char *key, size_t key_bytes, const char *value,
                      size_t value_bytes, bool quoted);

// Adds fields as printf would write them: `tool=%s reason="%s at %d"`. A value ends at a space or,
// in quotes, at the closing one. Understands %s (with a precision too), %d %i %u %x %c with their
// lengths, and %f %g %e.
void cau_log_line_print(cau_log_line *line, const char *format, va_list arguments);

// Ends the line: closes the object in JSON, and breaks the line.
void cau_log_line_end(cau_log_line *line);

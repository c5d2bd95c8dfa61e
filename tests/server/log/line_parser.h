// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the fields of a log line strictly by server/log/line.h, and refuses anything else. Shares
// no code with the writer.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { LINE_FIELDS_MOST = 64, LINE_VALUE_MOST = 512 };

typedef struct line_field {
	char key[32];
	char value[LINE_VALUE_MOST]; // the value before it was escaped
	size_t value_bytes;
} line_field;

typedef struct line_fields {
	line_field fields[LINE_FIELDS_MOST];
	int count;
} line_fields;

// Returns false if the bytes are not fields with one space between two.
bool line_parse(const char *text, size_t bytes, line_fields *fields);

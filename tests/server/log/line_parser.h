// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the fields of a log line by the letter of server/log/line.h, and nothing that departs from
// it. Shares no code with the writer.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { LINE_FIELDS_MOST = 64, LINE_VALUE_MOST = 512 };

typedef struct line_field {
	char key[32];
	char value[LINE_VALUE_MOST]; // as it was before escapes
	size_t value_bytes;
} line_field;

typedef struct line_fields {
	line_field fields[LINE_FIELDS_MOST];
	int count;
} line_fields;

// False if the bytes are not fields with one space between two.
bool line_parse(const char *text, size_t bytes, line_fields *fields);

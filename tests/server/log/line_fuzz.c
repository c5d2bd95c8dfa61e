// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes the values in a log line: the line reads back as the fields that were written, and in JSON
// it is an object.
#include "log/line.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/json_text.h"
#include "fuzz/fuzz_target.h"
#include "line_parser.h"

static void check(const line_field *field, const uint8_t *data, size_t size)
{
	static const char more[] = "...";
	size_t kept = field->value_bytes;
	if (kept == size && memcmp(field->value, data, size) == 0)
		return;
	if (kept < sizeof more - 1 || kept - (sizeof more - 1) > size ||
	    memcmp(field->value, data, kept - (sizeof more - 1)) != 0 ||
	    memcmp(field->value + kept - (sizeof more - 1), more, sizeof more - 1) != 0)
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	cau_log_line line = {.bytes = 0};
	line_fields fields;
	cau_log_line_add(&line, "event", 5, "hello", 5, false);
	cau_log_line_add(&line, "name", 4, (const char *)data, size, size % 2);
	cau_log_line_add(&line, "role", 4, "view", 4, false);
	if (!line_parse(line.text, line.bytes, &fields) || fields.count != 3)
		abort();
	check(&fields.fields[1], data, size);
	cau_log_line object = {.json = true};
	object.bytes = (size_t)snprintf(object.text, sizeof object.text, "{\"head\":0");
	cau_log_line_add(&object, "name", 4, (const char *)data, size, size % 2);
	cau_log_line_end(&object);
	if (cau_json_scan(object.text, object.bytes, sizeof object.text, NULL))
		abort();
	return 0;
}

// SPDX-License-Identifier: Apache-2.0
#include "cautery/json_writer.h"

#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/utf8.h"

// Bound of integers, 2^53: a double represents every smaller integer.
static const double integer_bound = 9007199254740992.0;

void cau_json_fail(cau_json_writer *writer, cau_status status, const char *reason, ...)
{
	va_list values;
	CAU_ASSERT(status != CAU_OK && reason, "a failure that is none: %s", reason);
	if (writer->status)
		return;
	writer->status = status;
	va_start(values, reason);
	vsnprintf(writer->reason, sizeof writer->reason, reason, values);
	va_end(values);
}

// Returns the name of a value for a message.
static const char *name_of(const char *key)
{
	return key ? key : "a value without a name";
}

static void put(cau_json_writer *writer, const char *text, size_t bytes)
{
	CAU_ASSERT(text || !bytes, "%zu bytes that are nowhere", bytes);
	if (writer->bytes < writer->capacity) {
		size_t room = writer->capacity - writer->bytes;
		memcpy(writer->buffer + writer->bytes, text, bytes < room ? bytes : room);
	}
	writer->bytes += bytes;
}

static void put_text(cau_json_writer *writer, const char *text)
{
	put(writer, text, strlen(text));
}

static void put_line_break(cau_json_writer *writer)
{
	CAU_ASSERT(writer->depth >= 0 && writer->depth <= CAU_JSON_MAX_DEPTH, "%d levels",
	           writer->depth);
	if (writer->indent == 0 || (writer->depth > 0 && writer->flat[writer->depth - 1]))
		return;
	put(writer, "\n", 1);
	for (int32_t i = 0; i < writer->depth * writer->indent; i++)
		put(writer, " ", 1);
}

static void put_quoted(cau_json_writer *writer, const char *text)
{
	static const char plain[] = "\"\\\b\f\n\r\t", escape[] = "\"\\bfnrt";
	put(writer, "\"", 1);
	for (size_t left = strlen(text); left > 0;) {
		size_t length = cau_utf8_length(text, left);
		const char *special = strchr(plain, *text);
		if (length == 0) {
			cau_json_fail(writer, CAU_BAD_VALUE,
			              "a string is not UTF-8: its last %zu bytes begin with byte 0x%02x", left,
			              (unsigned)(unsigned char)*text);
			break;
		}
		if (special) {
			put(writer, (char[]){'\\', escape[special - plain]}, 2);
		} else if ((unsigned char)*text < 0x20) {
			char code[8];
			snprintf(code, sizeof code, "\\u%04x", (unsigned)*text);
			put_text(writer, code);
		} else {
			put(writer, text, length);
		}
		text += length;
		left -= length;
	}
	put(writer, "\"", 1);
}

// Writes the text before a value: comma, line break and name.
static void put_lead(cau_json_writer *writer, const char *key)
{
	CAU_ASSERT(writer->depth >= 0 && writer->depth <= CAU_JSON_MAX_DEPTH, "%d levels",
	           writer->depth);
	if (writer->depth > 0) {
		int32_t top = writer->depth - 1;
		if (writer->occupied[top])
			put_text(writer, writer->flat[top] && writer->indent ? ", " : ",");
		writer->occupied[top] = true;
		put_line_break(writer);
		if ((key != NULL) != (writer->closing[top] == '}'))
			cau_json_fail(writer, CAU_BAD_STATE,
			              key ? "%s is a name inside an array" : "%s is inside an object",
			              name_of(key));
	}
	if (!key)
		return;
	put_quoted(writer, key);
	put_text(writer, writer->indent ? ": " : ":");
}

void cau_json_begin(cau_json_writer *writer, char *buffer, size_t capacity, int32_t indent)
{
	CAU_ASSERT(buffer || !capacity, "a buffer of %zu bytes that is nowhere", capacity);
	CAU_ASSERT(indent >= 0, "an indent of %d", indent);
	memset(writer, 0, sizeof *writer);
	writer->buffer = buffer;
	writer->capacity = capacity;
	writer->indent = indent;
}

void cau_json_open(cau_json_writer *writer, const char *key, char bracket)
{
	CAU_ASSERT(bracket == '{' || bracket == '[' || bracket == '(', "a level opened by '%c'",
	           bracket);
	put_lead(writer, key);
	if (writer->depth == CAU_JSON_MAX_DEPTH) {
		cau_json_fail(writer, CAU_BAD_STATE, "more than %d levels of objects and arrays",
		              CAU_JSON_MAX_DEPTH);
		return;
	}
	int32_t top = writer->depth++;
	writer->closing[top] = bracket == '{' ? '}' : ']';
	writer->occupied[top] = false;
	writer->flat[top] = bracket == '(' || (top > 0 && writer->flat[top - 1]);
	put(writer, bracket == '{' ? "{" : "[", 1);
}

void cau_json_close(cau_json_writer *writer)
{
	if (writer->depth == 0) {
		cau_json_fail(writer, CAU_BAD_STATE, "an object or array was closed that was not open");
		return;
	}
	int32_t top = writer->depth - 1;
	bool flat = writer->flat[top] || !writer->occupied[top];
	writer->depth--;
	if (!flat)
		put_line_break(writer);
	put(writer, &writer->closing[top], 1);
}

// Writes the number with the fewest digits, 15 to 17, that read back to the same bits.
static void format_number(double value, char text[40])
{
	CAU_ASSERT(isfinite(value), "%g is no number of JSON", value);
	for (int digits = 15; digits <= 17; digits++) {
		snprintf(text, 32, "%.*g", digits, value);
		if (strtod(text, NULL) == value)
			break;
	}
	char *point = strchr(text, localeconv()->decimal_point[0]);
	if (point)
		*point = '.';
	// A strict reader refuses large integers, which it would have to round. With ".0" it reads a
	// double.
	else if (!strchr(text, 'e') && fabs(value) >= integer_bound)
		memcpy(text + strlen(text), ".0", sizeof ".0");
}

void cau_json_number(cau_json_writer *writer, const char *key, double value)
{
	char text[40];
	put_lead(writer, key);
	if (!isfinite(value)) {
		cau_json_fail(writer, CAU_BAD_VALUE, "%s is %g, which JSON cannot represent", name_of(key),
		              value);
		return;
	}
	format_number(value, text);
	put_text(writer, text);
}

void cau_json_integer(cau_json_writer *writer, const char *key, int64_t value)
{
	char text[32];
	put_lead(writer, key);
	if (value >= INT64_C(1) << 53 || value <= -(INT64_C(1) << 53))
		cau_json_fail(writer, CAU_BAD_VALUE, "%s is %" PRId64 ", an integer of 2^53 or more",
		              name_of(key), value);
	snprintf(text, sizeof text, "%" PRId64, value);
	put_text(writer, text);
}

void cau_json_unsigned(cau_json_writer *writer, const char *key, uint64_t value)
{
	if (value >= UINT64_C(1) << 53)
		cau_json_fail(writer, CAU_BAD_VALUE, "%s is %" PRIu64 ", an integer of 2^53 or more",
		              name_of(key), value);
	cau_json_integer(writer, key, (int64_t)(value & INT64_MAX));
}

void cau_json_bool(cau_json_writer *writer, const char *key, bool value)
{
	put_lead(writer, key);
	put_text(writer, value ? "true" : "false");
}

void cau_json_null(cau_json_writer *writer, const char *key)
{
	put_lead(writer, key);
	put_text(writer, "null");
}

void cau_json_string(cau_json_writer *writer, const char *key, const char *value)
{
	put_lead(writer, key);
	put_quoted(writer, value);
}

void cau_json_numbers(cau_json_writer *writer, const char *key, const double *value, int32_t count)
{
	CAU_ASSERT(count >= 0, "%d numbers", count);
	cau_json_open(writer, key, '(');
	for (int32_t i = 0; i < count; i++)
		cau_json_number(writer, NULL, value[i]);
	cau_json_close(writer);
}

void cau_json_raw(cau_json_writer *writer, const char *key, const char *json, size_t bytes)
{
	CAU_ASSERT(bytes > 0, "a value of %zu bytes", bytes);
	put_lead(writer, key);
	put(writer, json, bytes);
}

cau_status cau_json_end(cau_json_writer *writer, size_t *bytes, cau_error *error)
{
	if (bytes)
		*bytes = writer->bytes;
	if (writer->capacity > 0)
		writer->buffer[writer->bytes < writer->capacity ? writer->bytes : writer->capacity - 1] = 0;
	if (writer->depth != 0)
		cau_json_fail(writer, CAU_BAD_STATE, "%d objects or arrays are still open", writer->depth);
	if (writer->status)
		return cau_fail(error, writer->status, NULL, "JSON cannot be written: %s", writer->reason);
	if (writer->bytes >= writer->capacity)
		return cau_fail(error, CAU_LIMIT, NULL, "the text needs %zu bytes, the buffer has %zu",
		                writer->bytes + 1, writer->capacity);
	return CAU_OK;
}

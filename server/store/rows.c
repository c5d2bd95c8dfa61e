// SPDX-License-Identifier: GPL-3.0-or-later
#include "rows.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

enum { SHORT_MOST = 127, FIRST_BYTES = 4096 };

static const unsigned char magic[4] = {'C', 'A', 'U', 'M'};

static const char *const columns_of[CAU_ROWS_COUNT] = {
#define X(name, columns) columns,
	CAU_ROWS_TABLE(X)
#undef X
};

// ---- numbers --------------------------------------------------------------------------
static uint32_t get32(const unsigned char *at)
{
	return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static uint64_t get64(const unsigned char *at)
{
	return get32(at) | (uint64_t)get32(at + 4) << 32;
}

static void set32(unsigned char *at, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		at[i] = (unsigned char)(value >> 8 * i);
}

static void set64(unsigned char *at, uint64_t value)
{
	set32(at, (uint32_t)value);
	set32(at + 4, (uint32_t)(value >> 32));
}

// ---- reading --------------------------------------------------------------------------
static cau_status corrupt(cau_error *error, const char *why)
{
	return cau_fail(error, CAU_CORRUPT, NULL, "not a piece of a moved session: %s", why);
}

cau_status cau_rows_open(cau_rows_reader *reader, const void *bytes, size_t byte_count,
                         cau_error *error)
{
	const unsigned char *at = bytes;
	if (byte_count < CAU_ROWS_HEAD_BYTES || memcmp(at, magic, sizeof magic) != 0)
		return corrupt(error, "the bytes do not begin with CAUM");
	if (get32(at + 4) != CAU_ROWS_VERSION)
		return cau_fail(error, CAU_UNSUPPORTED, NULL,
		                "the piece is of version %u and this build reads version %d: move between "
		                "daemons of one version",
		                (unsigned)get32(at + 4), CAU_ROWS_VERSION);
	*reader = (cau_rows_reader){.at = at + CAU_ROWS_HEAD_BYTES,
	                            .end = at + byte_count,
	                            .index = get32(at + 8),
	                            .flags = get32(at + 12)};
	if (reader->flags & ~(uint32_t)(CAU_ROWS_PART_ENDS | CAU_ROWS_ENDS))
		return corrupt(error, "the piece has unknown flags");
	return CAU_OK;
}

static cau_status read_bytes(cau_rows_reader *reader, cau_column *column, cau_error *error)
{
	if (reader->end - reader->at < 4)
		return corrupt(error, "the piece ends within a length");
	size_t bytes = get32(reader->at);
	reader->at += 4;
	if (bytes > (size_t)(reader->end - reader->at))
		return corrupt(error, "the piece ends within a column");
	column->bytes = (const char *)reader->at;
	column->byte_count = bytes;
	reader->at += bytes;
	return CAU_OK;
}

static cau_status read_column(cau_rows_reader *reader, cau_column *column, cau_error *error)
{
	*column = (cau_column){CAU_COLUMN_NULL, 0, NULL, 0};
	if (reader->at == reader->end)
		return corrupt(error, "the piece ends within a record");
	switch (*reader->at++) {
	case CAU_COLUMN_NULL:
		return CAU_OK;
	case CAU_COLUMN_INTEGER:
		if (reader->end - reader->at < 8)
			return corrupt(error, "the piece ends within a number");
		column->type = CAU_COLUMN_INTEGER;
		column->integer = (int64_t)get64(reader->at);
		reader->at += 8;
		return CAU_OK;
	case CAU_COLUMN_TEXT:
		column->type = CAU_COLUMN_TEXT;
		return read_bytes(reader, column, error);
	case CAU_COLUMN_BLOB:
		column->type = CAU_COLUMN_BLOB;
		return read_bytes(reader, column, error);
	default:
		return corrupt(error, "a column is of an unknown type");
	}
}

static bool is_text(const cau_column *column, size_t most)
{
	return column->type == CAU_COLUMN_TEXT && column->byte_count <= most &&
	       !memchr(column->bytes, 0, column->byte_count);
}

static bool fits(const cau_column *column, char wanted)
{
	switch (wanted) {
	case 'u':
		return column->type == CAU_COLUMN_INTEGER && column->integer >= 0;
	case 'i':
		return column->type == CAU_COLUMN_INTEGER;
	case 'k':
		return column->type == CAU_COLUMN_INTEGER || column->type == CAU_COLUMN_NULL;
	case 's':
		return is_text(column, SHORT_MOST);
	case 'n':
		return column->type == CAU_COLUMN_NULL || is_text(column, SHORT_MOST);
	case 't':
		return is_text(column, SIZE_MAX);
	default:
		return column->type == CAU_COLUMN_BLOB;
	}
}

cau_status cau_rows_next(cau_rows_reader *reader, cau_row *row, cau_error *error)
{
	if (reader->at == reader->end)
		return CAU_NOT_FOUND;
	if (reader->end - reader->at < 2)
		return corrupt(error, "the piece ends within a record");
	unsigned table = reader->at[0], count = reader->at[1];
	reader->at += 2;
	if (table >= CAU_ROWS_COUNT || count != strlen(columns_of[table]))
		return corrupt(error, "a record of an unknown table");
	row->table = (cau_rows_table)table;
	row->column_count = (int)count;
	for (unsigned i = 0; i < count; i++) {
		cau_status status = read_column(reader, &row->column[i], error);
		if (status)
			return status;
		if (!fits(&row->column[i], columns_of[table][i]))
			return corrupt(error, "a column has the wrong type for its table");
	}
	return CAU_OK;
}

cau_status cau_rows_check(const void *bytes, size_t byte_count, cau_error *error)
{
	cau_rows_reader reader;
	cau_row row;
	cau_status status = cau_rows_open(&reader, bytes, byte_count, error);
	while (!status)
		status = cau_rows_next(&reader, &row, error);
	return status == CAU_NOT_FOUND ? CAU_OK : status;
}

void cau_rows_text(const cau_row *row, int column, char *text, size_t capacity)
{
	CAU_ASSERT_INDEX(column, row->column_count);
	const cau_column *from = &row->column[column];
	size_t bytes = from->byte_count < capacity ? from->byte_count : capacity - 1;
	if (bytes)
		memcpy(text, from->bytes, bytes);
	text[bytes] = 0;
}

// ---- writing --------------------------------------------------------------------------
static size_t column_bytes(const cau_column *column)
{
	if (column->type == CAU_COLUMN_NULL)
		return 1;
	return column->type == CAU_COLUMN_INTEGER ? 1 + 8 : 1 + 4 + column->byte_count;
}

size_t cau_rows_bytes(const cau_row *row)
{
	size_t bytes = 2;
	for (int i = 0; i < row->column_count; i++)
		bytes += column_bytes(&row->column[i]);
	return bytes;
}

// Extends the writer's buffer by `bytes` and returns the start of the new part. Returns NULL if
// memory ran out.
static unsigned char *grow(cau_rows_writer *writer, size_t bytes)
{
	size_t wanted = writer->byte_count + bytes, capacity = writer->capacity;
	if (writer->failed)
		return NULL;
	while (capacity < wanted)
		capacity = capacity ? 2 * capacity : FIRST_BYTES;
	if (capacity != writer->capacity) {
		unsigned char *grown = realloc(writer->bytes, capacity);
		if (!grown) {
			writer->failed = true;
			return NULL;
		}
		writer->bytes = grown;
		writer->capacity = capacity;
	}
	writer->byte_count = wanted;
	return writer->bytes + wanted - bytes;
}

void cau_rows_begin(cau_rows_writer *writer, uint32_t index)
{
	*writer = (cau_rows_writer){0};
	unsigned char *head = grow(writer, CAU_ROWS_HEAD_BYTES);
	if (!head)
		return;
	memcpy(head, magic, sizeof magic);
	set32(head + 4, CAU_ROWS_VERSION);
	set32(head + 8, index);
	set32(head + 12, 0);
}

void cau_rows_flag(cau_rows_writer *writer, uint32_t flags)
{
	if (!writer->failed)
		set32(writer->bytes + 12, get32(writer->bytes + 12) | flags);
}

void cau_rows_append(cau_rows_writer *writer, const void *bytes, size_t byte_count)
{
	unsigned char *at = grow(writer, byte_count);
	if (at)
		memcpy(at, bytes, byte_count);
}

void cau_rows_put(cau_rows_writer *writer, const cau_row *row)
{
	CAU_ASSERT(row->column_count == (int)strlen(columns_of[row->table]), "%d columns of table %d",
	           row->column_count, (int)row->table);
	unsigned char *at = grow(writer, cau_rows_bytes(row));
	if (!at)
		return;
	*at++ = (unsigned char)row->table;
	*at++ = (unsigned char)row->column_count;
	for (int i = 0; i < row->column_count; i++) {
		const cau_column *column = &row->column[i];
		CAU_ASSERT(fits(column, columns_of[row->table][i]), "column %d of table %d", i,
		           (int)row->table);
		*at++ = (unsigned char)column->type;
		if (column->type == CAU_COLUMN_INTEGER) {
			set64(at, (uint64_t)column->integer);
			at += 8;
		} else if (column->type != CAU_COLUMN_NULL) {
			set32(at, (uint32_t)column->byte_count);
			if (column->byte_count)
				memcpy(at + 4, column->bytes, column->byte_count);
			at += 4 + column->byte_count;
		}
	}
}

void cau_rows_put_values(cau_rows_writer *writer, cau_rows_table table, ...)
{
	cau_row row = {.table = table, .column_count = (int)strlen(columns_of[table])};
	va_list values;
	va_start(values, table);
	for (int i = 0; i < row.column_count; i++) {
		cau_column *column = &row.column[i];
		if (strchr("uik", columns_of[table][i])) {
			column->type = CAU_COLUMN_INTEGER;
			column->integer = va_arg(values, int64_t);
			continue;
		}
		column->type = CAU_COLUMN_TEXT;
		column->bytes = va_arg(values, const char *);
		column->byte_count = strlen(column->bytes);
	}
	va_end(values);
	cau_rows_put(writer, &row);
}

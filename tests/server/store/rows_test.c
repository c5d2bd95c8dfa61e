// SPDX-License-Identifier: GPL-3.0-or-later
// Tests pieces of a moving session: written rows are read again, and bytes that are not a piece are
// refused, wherever they end and whatever they contain.
#include "store_fixture.h"

#include <stdlib.h>
#include <string.h>

#include "store/rows.h"

static cau_rows_writer make_piece(void)
{
	cau_rows_writer piece;
	cau_rows_begin(&piece, 3);
	cau_rows_put_values(&piece, CAU_ROWS_HEADER, "m1", "lock", "d1-knee", "d1", "knee", "unlock");
	cau_row row = {.table = CAU_ROWS_COMMANDS, .column_count = 7};
	for (int i = 0; i < 4; i++)
		row.column[i] = (cau_column){CAU_COLUMN_INTEGER, 5 + i, NULL, 0};
	row.column[6] = (cau_column){CAU_COLUMN_BLOB, 0, "\0\1\2", 3};
	cau_rows_put(&piece, &row);
	cau_rows_put_values(&piece, CAU_ROWS_DRIVERS, "hook", "token", "anna", "viewer", (int64_t)1,
	                    (int64_t)250000);
	cau_rows_flag(&piece, CAU_ROWS_ENDS);
	assert_false(piece.failed);
	return piece;
}

static void what_is_written_is_read_again(void **state)
{
	(void)state;
	cau_rows_writer piece = make_piece();
	cau_rows_reader reader;
	cau_row row;
	char text[16];
	assert_int_equal(cau_rows_open(&reader, piece.bytes, piece.byte_count, NULL), CAU_OK);
	assert_int_equal(reader.index, 3);
	assert_int_equal(reader.flags, CAU_ROWS_ENDS);
	assert_int_equal(cau_rows_next(&reader, &row, NULL), CAU_OK);
	assert_int_equal(row.table, CAU_ROWS_HEADER);
	cau_rows_text(&row, 2, text, sizeof text);
	assert_string_equal(text, "d1-knee");
	cau_rows_text(&row, 2, text, 4);
	assert_string_equal(text, "d1-");
	assert_int_equal(cau_rows_next(&reader, &row, NULL), CAU_OK);
	assert_int_equal(row.column[3].integer, 8);
	assert_int_equal(row.column[4].type, CAU_COLUMN_NULL);
	assert_memory_equal(row.column[6].bytes, "\0\1\2", 3);
	assert_int_equal(cau_rows_next(&reader, &row, NULL), CAU_OK);
	assert_int_equal(row.column[5].integer, 250000);
	assert_int_equal(cau_rows_next(&reader, &row, NULL), CAU_NOT_FOUND);
	free(piece.bytes);
}

// Checks a copy of the exact size, so that a sanitizer detects a read beyond it.
static cau_status check_copy(const unsigned char *bytes, size_t count)
{
	unsigned char *copy = malloc(count + !count);
	memcpy(copy, bytes, count);
	cau_status status = cau_rows_check(copy, count, NULL);
	free(copy);
	return status;
}

static void one_that_ends_too_soon_is_refused(void **state)
{
	(void)state;
	cau_rows_writer piece = make_piece();
	int whole = 0;
	for (size_t count = 0; count <= piece.byte_count; count++)
		whole += check_copy(piece.bytes, count) == CAU_OK;
	assert_int_equal(whole, 4); // complete pieces are the head alone, and the piece after each row
	free(piece.bytes);
}

static void other_versions_flags_and_types_are_refused(void **state)
{
	(void)state;
	static const struct {
		size_t at;
		unsigned char is;
		cau_status status;
	} changes[] = {
		{0, 'X', CAU_CORRUPT},   {4, CAU_ROWS_VERSION + 1, CAU_UNSUPPORTED},
		{12, 4, CAU_CORRUPT},    {16, 99, CAU_CORRUPT},
		{17, 4, CAU_CORRUPT},    {18, CAU_COLUMN_BLOB, CAU_CORRUPT},
		{18, 9, CAU_CORRUPT},    {19, 200, CAU_CORRUPT},
		{22, 0xff, CAU_CORRUPT}, {23, 0, CAU_CORRUPT}, // a zero within a text
	};
	cau_rows_writer piece = make_piece();
	for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
		unsigned char kept = piece.bytes[changes[i].at];
		piece.bytes[changes[i].at] = changes[i].is;
		assert_int_equal(check_copy(piece.bytes, piece.byte_count), changes[i].status);
		piece.bytes[changes[i].at] = kept;
	}
	free(piece.bytes);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_written_is_read_again),
		cmocka_unit_test(one_that_ends_too_soon_is_refused),
		cmocka_unit_test(other_versions_flags_and_types_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

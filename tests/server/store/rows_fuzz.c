// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes the pieces of a session. A piece that is accepted must give the same bytes when it is
// written again.
#include "fuzz/fuzz_target.h"

#include <stdlib.h>
#include <string.h>

#include "store/rows.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	cau_rows_reader reader;
	cau_rows_writer again;
	cau_row row;
	if (cau_rows_check(data, bytes, NULL) || cau_rows_open(&reader, data, bytes, NULL))
		return 0;
	cau_rows_begin(&again, reader.index);
	cau_rows_flag(&again, reader.flags);
	while (!cau_rows_next(&reader, &row, NULL))
		cau_rows_put(&again, &row);
	if (again.failed || again.byte_count != bytes || memcmp(again.bytes, data, bytes) != 0)
		abort();
	free(again.bytes);
	return 0;
}

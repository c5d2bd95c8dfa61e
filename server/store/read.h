// SPDX-License-Identifier: GPL-3.0-or-later
// What the reads share. All are called with the reader's mutex held.
#pragma once

#include "store_state.h"

cau_status cau_store_prepare(struct cau_store_reader *reader, const char *sql,
                             sqlite3_stmt **statement, cau_error *error);
// Advances to the next row. CAU_NOT_FOUND (without a report) at the end.
cau_status cau_store_next_row(struct cau_store_reader *reader, sqlite3_stmt *statement,
                              cau_error *error);
cau_status cau_store_end_is_fine(cau_status status); // CAU_NOT_FOUND becomes CAU_OK
const char *cau_store_column_text(sqlite3_stmt *statement, int column);
cau_status cau_store_find_session(struct cau_store_reader *reader, const char *id, int64_t *key,
                                  cau_error *error);

// A stretch of the line from a branch to the root: the branch, and where the next one forks from
// it.
struct cau_store_stretch {
	int64_t branch;
	int64_t from_tick, before_tick;
};

// Fills *line (free()d by the caller) from the branch up to the root, each stretch later than the
// next.
cau_status cau_store_find_line(struct cau_store_reader *reader, int64_t key, int64_t branch,
                               struct cau_store_stretch **line, int *count, cau_error *error);

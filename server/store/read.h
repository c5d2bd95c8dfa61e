// SPDX-License-Identifier: GPL-3.0-or-later
// Shared functions of the reads. The caller of each holds the reader's mutex.
#pragma once

#include "store_state.h"

cau_status cau_store_prepare(struct cau_store_reader *reader, const char *sql,
                             sqlite3_stmt **statement, cau_error *error);
// Advances to the next row. At the end returns CAU_NOT_FOUND, without filling *error.
cau_status cau_store_next_row(struct cau_store_reader *reader, sqlite3_stmt *statement,
                              cau_error *error);
cau_status cau_store_end_is_fine(cau_status status); // turns CAU_NOT_FOUND into CAU_OK
const char *cau_store_column_text(sqlite3_stmt *statement, int column);
cau_status cau_store_find_session(struct cau_store_reader *reader, const char *id, int64_t *key,
                                  cau_error *error);

// One branch of the line to the root, with the ticks that the line takes from it. before_tick is
// where the next branch forks from it.
struct cau_store_stretch {
	int64_t branch;
	int64_t from_tick, before_tick;
};

// Fills *line (the caller frees it with free()) from the branch up to the root. Each stretch is
// later than the one after it.
cau_status cau_store_find_line(struct cau_store_reader *reader, int64_t key, int64_t branch,
                               struct cau_store_stretch **line, int *count, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// The steps that remove records from a branch that a rewind has left, or from the present history.
// retention.c decides which step and when. In all functions *rows is 0 before the call, and the
// number of removed rows after it.
#pragma once

#include <sqlite3.h>
#include <stdbool.h>

#include "course.h"
#include "store/store.h"

enum { CAU_STORE_ROWS_A_STEP = 256 };
#define CAU_STORE_ROWS "LIMIT 256" // SQL: at most CAU_STORE_ROWS_A_STEP rows in a step
_Static_assert(CAU_STORE_ROWS_A_STEP == 256, "CAU_STORE_ROWS says the same");

// Result of a statement: number of rows, sum and minimum of columns, and the last row.
struct cau_store_outcome {
	int64_t rows;
	int64_t sum;      // sum of column 0
	int64_t least;    // minimum of column 1
	int64_t value[4]; // values of the last row
};

// Runs one statement. `parameter` has as many integers as the statement has parameters; NULL if it
// has none.
cau_status cau_store_run(sqlite3 *database, const char *sql, const int64_t *parameter,
                         struct cau_store_outcome *outcome, cau_error *error);

// Takes one step on the branch that was left first, among those left by left_before_ms, of
// `session` or, if that is 0, of any session. Removes its newest ticks, as long as no other branch
// forks from them and no mark is there.
cau_status cau_store_trim_left(sqlite3 *database, int64_t left_before_ms, int64_t session,
                               int64_t *rows, cau_error *error);

// The present line of a session, and its stored history.
struct cau_store_present {
	int64_t session, branch;
	int64_t bytes; // bytes of the whole session
	struct cau_store_course course;
};

cau_status cau_store_drop_point(sqlite3 *database, int64_t session,
                                const struct cau_store_point *point, int64_t *rows,
                                cau_error *error);
// Removes the oldest segment of log, from one checkpoint to the next; never a segment from the
// newest checkpoint but one on. The segment becomes a gap at once.
cau_status cau_store_trim_log(sqlite3 *database, const struct cau_store_present *present,
                              int64_t *rows, cau_error *error);
// Removes some commands inside gaps, which cau_store_trim_log has opened.
cau_status cau_store_empty_gaps(sqlite3 *database, int64_t *rows, cau_error *error);

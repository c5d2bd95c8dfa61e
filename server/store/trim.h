// SPDX-License-Identifier: GPL-3.0-or-later
// What one step takes from a branch that was left or from the present line. Which of them, and
// when, is retention.c's to say. *rows is 0 before, and what was removed after.
#pragma once

#include <sqlite3.h>
#include <stdbool.h>

#include "course.h"
#include "store/store.h"

enum { CAU_STORE_ROWS_A_STEP = 256 };
#define CAU_STORE_ROWS "LIMIT 256" // CAU_STORE_ROWS_A_STEP
_Static_assert(CAU_STORE_ROWS_A_STEP == 256, "CAU_STORE_ROWS says the same");

// What a statement gave: rows, the sum and the least of its columns, and its last row.
struct cau_store_outcome {
	int64_t rows;
	int64_t sum;      // of column 0
	int64_t least;    // of column 1
	int64_t value[4]; // of the last row
};

// Runs one statement with as many integers as it has parameters; NULL: it has none.
cau_status cau_store_run(sqlite3 *database, const char *sql, const int64_t *parameter,
                         struct cau_store_outcome *outcome, cau_error *error);

// Of the branch that was left first, among those left by left_before_ms, of `session` or, if that
// is 0, of any: its newest ticks, as far as no other branch was forked from them and no mark is
// there.
cau_status cau_store_trim_left(sqlite3 *database, int64_t left_before_ms, int64_t session,
                               int64_t *rows, cau_error *error);

// The present line of a session, and what is kept of it.
struct cau_store_present {
	int64_t session, branch;
	int64_t bytes; // of the whole session
	struct cau_store_course course;
};

cau_status cau_store_drop_point(sqlite3 *database, int64_t session,
                                const struct cau_store_point *point, int64_t *rows,
                                cau_error *error);
// The oldest stretch of log goes, from one checkpoint to the next: never from the newest but one
// on. It is a gap at once.
cau_status cau_store_trim_log(sqlite3 *database, const struct cau_store_present *present,
                              int64_t *rows, cau_error *error);
// A step of what cau_store_trim_log has begun: commands in gaps.
cau_status cau_store_empty_gaps(sqlite3 *database, int64_t *rows, cau_error *error);

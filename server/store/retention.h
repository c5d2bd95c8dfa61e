// SPDX-License-Identifier: GPL-3.0-or-later
// The stored history of a line, and what retention removes from it in small steps.
#pragma once

#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"
#include "store/store.h"

// ---- history ------------------------------------------------------------------------------------
// The stored history of one line, from its root to the end of a branch: the ticks of its
// checkpoints, and the ranges whose log is missing. Reads use it to find which ticks can be
// reached. Retention uses this to find the records that it may remove.

// A line as an SQL table, for session ?1 and branch ?2: each branch from ?2 to the root, with its
// first tick and the tick where the next one starts. If a damaged file has a cycle of branches, the
// table ends after 100,000 entries.
#define CAU_STORE_LINE                                                                             \
	"WITH RECURSIVE line(branch, parent, from_tick, before_tick, depth) AS ("                      \
	" SELECT branch, parent, fork_tick, 9223372036854775807, 0 FROM branches"                      \
	" WHERE session = ?1 AND branch = ?2"                                                          \
	" UNION ALL SELECT up.branch, up.parent, up.fork_tick, line.from_tick, depth + 1"              \
	" FROM line JOIN branches AS up ON up.session = ?1 AND up.branch = line.parent"                \
	" LIMIT 100000) "

// A checkpoint in the line.
struct cau_store_point {
	int64_t branch, tick, bytes;
	bool marked; // a marked state: retention must keep it
};

// A range of ticks, from_tick <= tick < before_tick, in which some or all commands are missing. No
// state within it can be reached.
struct cau_store_hole {
	int64_t from_tick, before_tick;
};

struct cau_store_course {
	struct cau_store_point *point; // ordered by tick; an ancestor's before its descendant's
	struct cau_store_hole *hole;   // ordered by from_tick
	int point_count, hole_count;
};

// Fills a zeroed course. Free it with cau_store_course_finish, whatever the status is.
cau_status cau_store_course_read(sqlite3 *database, int64_t session, int64_t branch,
                                 struct cau_store_course *course, cau_error *error);
void cau_store_course_finish(struct cau_store_course *course);

// A range of ticks that can be reached, including both ends. to_tick is INT64_MAX if the range
// extends to the present.
struct cau_store_range {
	int64_t from_tick, to_tick;
};

// Finds the first range that ends after tick `after` (-1: the first range of all). Returns false if
// there is none.
bool cau_store_course_range(const struct cau_store_course *course, int64_t after,
                            struct cau_store_range *range);

// Returns the index of the checkpoint that thinning removes next; -1 if none. A checkpoint can be
// removed if its two neighbours are at most `spacing` ticks apart, or at most a quarter of the
// later one's age. So the number of checkpoints grows with the logarithm of time. A view of `a`
// ticks ago needs a replay of at most a / 4 ticks. These checkpoints always stay: the first, the
// newest two, marked checkpoints, and a checkpoint at the end of a hole.
int cau_store_course_thin(const struct cau_store_course *course, int64_t spacing);

// Returns the index of the oldest checkpoint that may be removed; -1 if none may.
int cau_store_course_oldest(const struct cau_store_course *course);

// Returns the index of the checkpoint whose removal lengthens replays least for its age; -1 if all
// must stay.
int cau_store_course_coarsen(const struct cau_store_course *course, int64_t spacing);

// ---- removal ------------------------------------------------------------------------------------
// The steps that remove records from a branch that a rewind has left, or from the present history.
// retention.c decides which step and when. In all functions *rows is 0 before the call, and the
// number of removed rows after it.

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

// ---- retention ----------------------------------------------------------------------------------
// Removes what retention allows, in small steps.

// The state of the store's budget between two steps; zeroed at the start.
struct cau_store_budget {
	cau_store_budget_state state;
	int64_t bytes;   // bytes of the file in use at the last check
	int64_t dropped; // checkpoints removed for the budget so far
};

// Takes one small step in a transaction of its own: at most some hundred rows of tables, or one
// checkpoint. *rows: the number of removed rows; 0: nothing may be removed at present. On failure
// `budget` is unchanged.
cau_status cau_store_retention_step(sqlite3 *database, const cau_store_config *config,
                                    struct cau_store_budget *budget, int64_t *rows,
                                    cau_error *error);

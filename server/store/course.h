// SPDX-License-Identifier: GPL-3.0-or-later
// What is kept of one line, from its root to the end of a branch: the ticks of its checkpoints and
// the stretches whose log is missing. Reads tell from it what can be reached, retention what may
// go.
#pragma once

#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

// A line as a table of SQL, for session ?1 and branch ?2: each branch from there to the root, with
// the tick it starts at and the one where the next starts. Of a file with branches in a circle it
// takes the first 100,000.
#define CAU_STORE_LINE                                                                             \
	"WITH RECURSIVE line(branch, parent, from_tick, before_tick, depth) AS ("                      \
	" SELECT branch, parent, fork_tick, 9223372036854775807, 0 FROM branches"                      \
	" WHERE session = ?1 AND branch = ?2"                                                          \
	" UNION ALL SELECT up.branch, up.parent, up.fork_tick, line.from_tick, depth + 1"              \
	" FROM line JOIN branches AS up ON up.session = ?1 AND up.branch = line.parent"                \
	" LIMIT 100000) "

// A checkpoint of the line.
struct cau_store_point {
	int64_t branch, tick, bytes;
	bool marked; // a state that retention must keep
};

// The commands with from_tick <= tick < before_tick are missing, some or all: from within, no state
// can be reached.
struct cau_store_hole {
	int64_t from_tick, before_tick;
};

struct cau_store_course {
	struct cau_store_point *point; // by tick, an ancestor's before its child's
	struct cau_store_hole *hole;   // by from_tick
	int point_count, hole_count;
};

// Fills a zeroed course; free it by cau_store_course_finish whatever the status.
cau_status cau_store_course_read(sqlite3 *database, int64_t session, int64_t branch,
                                 struct cau_store_course *course, cau_error *error);
void cau_store_course_finish(struct cau_store_course *course);

// A stretch of ticks that can be reached, both ends among them. INT64_MAX: on to the present.
struct cau_store_range {
	int64_t from_tick, to_tick;
};

// The first range that ends after tick `after` (-1: the first of all). False if there is none.
bool cau_store_course_range(const struct cau_store_course *course, int64_t after,
                            struct cau_store_range *range);

// The checkpoint that thinning drops next; -1: none. One goes if its neighbours then stand no
// further apart than `spacing` ticks, or a quarter of the way from the later one to the newest. So
// the number of checkpoints grows with the logarithm of time, and to see what was `a` ticks ago
// takes a replay of at most a / 4. Never goes the first, the newest two, a marked one, or the end
// of a hole.
int cau_store_course_thin(const struct cau_store_course *course, int64_t spacing);

// The oldest that may go at all; -1: none.
int cau_store_course_oldest(const struct cau_store_course *course);

// The checkpoint whose loss would lengthen replays least for its age; -1: all must stay.
int cau_store_course_coarsen(const struct cau_store_course *course, int64_t spacing);

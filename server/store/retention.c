// SPDX-License-Identifier: GPL-3.0-or-later
// What may go: sessions that were deleted; of a branch that was left, what no other branch was
// forked from; of the present line, checkpoints that stand close for their age (course.h), and the
// oldest log of a session that is too big; old answers and events. Marked states stay.
//
// A branch that was left loses its newest ticks first, so that what is left of it is always a whole
// beginning. The present line loses its log from the oldest on, as gaps that are told.
#include "retention.h"

#include <stdbool.h>

#include "course.h"
#include "fault.h"

enum {
	ROWS_A_STEP = 256,
	ROW_BYTES = 64,            // as write.c counts a command
	FREED_SHARE = 20,          // of the budget, once it was overdrawn
	LEAST_SPACING_TICKS = 600, // thinning does not look closer: 10 s at 60 Hz, replayed in 3
};

// What a statement gave: rows, the sum and the least of its columns, and its last row.
struct outcome {
	int64_t rows;
	int64_t sum;      // of column 0
	int64_t least;    // of column 1
	int64_t value[4]; // of the last row
};

// Runs one statement with as many integers as it has parameters; NULL: it has none.
static cau_status run(sqlite3 *database, const char *sql, const int64_t *parameter,
                      struct outcome *outcome, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	*outcome = (struct outcome){.least = INT64_MAX};
	int code = sqlite3_prepare_v2(database, sql, -1, &statement, NULL);
	// The analyzer cannot know how many parameters a statement has.
	for (int i = 0; !code && parameter && i < sqlite3_bind_parameter_count(statement); i++)
		code = sqlite3_bind_int64(statement, i + 1, parameter[i]); // NOLINT(clang-analyzer-core.*)
	while (!code && (code = sqlite3_step(statement)) == SQLITE_ROW) {
		code = SQLITE_OK;
		outcome->rows++;
		for (int i = 0; i < sqlite3_column_count(statement) && i < 4; i++)
			outcome->value[i] = sqlite3_column_int64(statement, i);
		outcome->sum += outcome->value[0];
		if (outcome->value[1] < outcome->least)
			outcome->least = outcome->value[1];
	}
	cau_status status =
		code == SQLITE_DONE ? CAU_OK : cau_store_fault(database, code, "retention", error);
	if (!status && sqlite3_column_count(statement) == 0)
		outcome->rows = sqlite3_changes(database);
	sqlite3_finalize(statement);
	return status;
}

#define STEP "LIMIT 256" // ROWS_A_STEP
_Static_assert(ROWS_A_STEP == 256, "STEP says the same");

// ---- deleted sessions -----------------------------------------------------------------
static cau_status remove_deleted(sqlite3 *database, int64_t *rows, cau_error *error)
{
	static const char *const removals[] = {
		"DELETE FROM commands WHERE session = ?1 AND (branch, tick, position) IN"
		" (SELECT branch, tick, position FROM commands WHERE session = ?1 " STEP ")",
		"DELETE FROM checkpoints WHERE rowid IN"
		" (SELECT rowid FROM checkpoints WHERE session = ?1 LIMIT 1)",
		"DELETE FROM events WHERE key IN (SELECT key FROM events WHERE session = ?1 " STEP ")",
		"DELETE FROM clients WHERE session = ?1 AND client IN"
		" (SELECT client FROM clients WHERE session = ?1 " STEP ")",
		"DELETE FROM marks WHERE session = ?1",
		"DELETE FROM gaps WHERE session = ?1",
		"DELETE FROM branches WHERE session = ?1 AND branch IN"
		" (SELECT branch FROM branches WHERE session = ?1 " STEP ")",
		"DELETE FROM sessions WHERE key = ?1",
	};
	struct outcome found, removed = {0};
	cau_status status =
		run(database, "SELECT key FROM sessions WHERE deleted = 1 LIMIT 1", NULL, &found, error);
	if (status || !found.rows)
		return status;
	for (size_t i = 0; i < sizeof removals / sizeof *removals && !status && !removed.rows; i++)
		status = run(database, removals[i], found.value, &removed, error);
	*rows = removed.rows;
	return status;
}

// ---- left branches --------------------------------------------------------------------
static cau_status shrink_branch(sqlite3 *database, int64_t session, int64_t branch, int64_t bytes,
                                int64_t end_tick, cau_error *error)
{
	char sql[256];
	struct outcome done;
	snprintf(sql, sizeof sql,
	         "UPDATE branches SET bytes = bytes - ?3, end_tick = min(end_tick, %lld)"
	         " WHERE session = ?1 AND branch = ?2",
	         (long long)end_tick);
	return run(database, sql, (const int64_t[]){session, branch, bytes}, &done, error);
}

// One step on a branch of which everything from tick `keep` on may go; keep = -1: all, itself too.
static cau_status trim_branch(sqlite3 *database, int64_t session, int64_t branch, int64_t keep,
                              int64_t *rows, cau_error *error)
{
	const int64_t parameter[] = {session, branch, keep};
	struct outcome removed;
	// A checkpoint at the fork itself is shared.
	cau_status status =
		run(database,
	        "DELETE FROM checkpoints WHERE rowid IN (SELECT rowid FROM checkpoints"
	        " WHERE session = ?1 AND branch = ?2 AND tick > ?3 ORDER BY tick DESC LIMIT 1)"
	        " RETURNING bytes, tick",
	        parameter, &removed, error);
	removed.least = INT64_MAX; // its absence cuts no log
	if (!status && !removed.rows) {
		status = run(database,
		             "DELETE FROM commands WHERE session = ?1 AND branch = ?2 AND (tick, position)"
		             " IN (SELECT tick, position FROM commands WHERE session = ?1 AND branch = ?2"
		             "  AND tick >= ?3 ORDER BY tick DESC, position DESC " STEP ")"
		             " RETURNING length(payload), tick",
		             parameter, &removed, error);
		removed.sum += removed.rows * ROW_BYTES;
	}
	if (status)
		return status;
	*rows = removed.rows;
	if (removed.rows)
		return shrink_branch(database, session, branch, removed.sum, removed.least, error);
	if (keep >= 0)
		return shrink_branch(database, session, branch, 0, keep, error);
	status = run(database, "DELETE FROM branches WHERE session = ?1 AND branch = ?2", parameter,
	             &removed, error);
	*rows = removed.rows;
	return status;
}

// The branch that was left first and has something that may go, among those left before ?1, of
// session ?2 or, if that is 0, of any.
#define LEFT_BRANCH                                                                                \
	"SELECT session, branch, keep FROM (SELECT session, branch, end_tick, left_ms,"                \
	" max(coalesce((SELECT max(fork_tick) FROM branches AS child"                                  \
	"  WHERE child.session = parent.session AND child.parent = parent.branch), -1),"               \
	"  coalesce((SELECT max(tick) FROM marks WHERE marks.session = parent.session"                 \
	"   AND marks.branch = parent.branch), -1)) AS keep"                                           \
	" FROM branches AS parent WHERE left_ms > 0 AND left_ms <= ?1 AND ?2 IN (0, session))"         \
	" WHERE end_tick > keep ORDER BY left_ms, branch LIMIT 1"

static cau_status trim_left(sqlite3 *database, int64_t left_before_ms, int64_t session,
                            int64_t *rows, cau_error *error)
{
	struct outcome found;
	cau_status status =
		run(database, LEFT_BRANCH, (const int64_t[]){left_before_ms, session}, &found, error);
	while (!status && found.rows && !*rows) {
		status = trim_branch(database, found.value[0], found.value[1], found.value[2], rows, error);
		if (!status && !*rows) // it had nothing, which is now known: the next one
			status = run(database, LEFT_BRANCH, (const int64_t[]){left_before_ms, session}, &found,
			             error);
	}
	return status;
}

// ---- checkpoints and log of the present line ------------------------------------------
// The present line of a session, and what is kept of it.
struct present {
	int64_t session, branch;
	int64_t bytes; // of the whole session
	struct cau_store_course course;
};

static cau_status drop_point(sqlite3 *database, int64_t session,
                             const struct cau_store_point *point, int64_t *rows, cau_error *error)
{
	struct outcome removed;
	cau_status status =
		run(database,
	        "DELETE FROM checkpoints WHERE session = ?1 AND branch = ?2 AND tick = ?3"
	        " RETURNING bytes",
	        (const int64_t[]){session, point->branch, point->tick}, &removed, error);
	if (status)
		return status;
	*rows += removed.rows;
	return shrink_branch(database, session, point->branch, removed.sum, INT64_MAX, error);
}

// A segment of the line leads from the checkpoint at ?3 to the next, at ?4.
#define SEGMENT_HAS_LOG                                                                            \
	CAU_STORE_LINE "SELECT 1 FROM line CROSS JOIN commands AS k ON k.session = ?1"                 \
				   " AND k.branch = line.branch AND k.tick >= max(?3, line.from_tick)"             \
				   " AND k.tick < min(?4, line.before_tick) LIMIT 1"

// A state that must stay and has no checkpoint of its own, or where another line that is kept
// leaves this one.
#define SEGMENT_IS_NEEDED                                                                          \
	CAU_STORE_LINE "SELECT 1 FROM line CROSS JOIN marks AS m ON m.session = ?1"                    \
				   " AND m.branch = line.branch AND m.tick > ?3 AND m.tick < ?4"                   \
				   " AND m.tick <= line.before_tick UNION ALL"                                     \
				   " SELECT 1 FROM line CROSS JOIN branches AS b ON b.session = ?1"                \
				   " AND b.parent = line.branch AND b.fork_tick > ?3 AND b.fork_tick < ?4"         \
				   " AND b.fork_tick <= line.before_tick"                                          \
				   " AND b.branch NOT IN (SELECT branch FROM line) LIMIT 1"

static cau_status may_lose_log(sqlite3 *database, const int64_t segment[4], bool *may,
                               cau_error *error)
{
	struct outcome log, need;
	cau_status status = run(database, SEGMENT_HAS_LOG, segment, &log, error);
	if (!status)
		status = run(database, SEGMENT_IS_NEEDED, segment, &need, error);
	*may = !status && log.rows && !need.rows;
	return status;
}

// Notes the segment as a gap, so that from this transaction on nobody goes there; its commands go
// in the next steps. It lengthens the gap before it, and the checkpoint between the two goes.
static cau_status open_gap(sqlite3 *database, const struct present *present, int index,
                           int64_t *rows, cau_error *error)
{
	const struct cau_store_course *course = &present->course;
	const struct cau_store_point *from = &course->point[index];
	const int64_t segment[] = {present->session, present->branch, from->tick, from[1].tick};
	struct outcome done;
	bool follows = false;
	for (int i = 0; i < course->hole_count; i++)
		follows |= course->hole[i].before_tick == from->tick;
	// A gap that ends where this one begins grows instead.
	cau_status status = run(
		database,
		CAU_STORE_LINE "INSERT INTO gaps SELECT ?1, branch,"
					   " coalesce((SELECT g.from_tick FROM gaps AS g WHERE g.session = ?1"
					   "  AND g.branch = line.branch AND g.before_tick = max(?3, line.from_tick)"
					   "  AND g.trimmed = 1), max(?3, line.from_tick)),"
					   " min(?4, line.before_tick), 1 FROM line"
					   " WHERE line.from_tick < ?4 AND line.before_tick > ?3"
					   " ON CONFLICT(session, branch, from_tick) DO UPDATE"
					   " SET before_tick = max(before_tick, excluded.before_tick), trimmed = 1",
		segment, &done, error);
	*rows += !status;
	if (!status && follows && index > 0 && !from->marked)
		status = drop_point(database, present->session, from, rows, error);
	return status;
}

// The oldest stretch of log goes, from one checkpoint to the next: never from the newest but one
// on.
static cau_status trim_log(sqlite3 *database, const struct present *present, int64_t *rows,
                           cau_error *error)
{
	const struct cau_store_course *course = &present->course;
	for (int i = 0; i + 2 < course->point_count; i++) {
		const struct cau_store_point *from = &course->point[i];
		bool may, covered = false;
		for (int k = 0; k < course->hole_count; k++)
			covered |= course->hole[k].from_tick <= from->tick &&
			           course->hole[k].before_tick >= from[1].tick;
		if (covered || from->tick == from[1].tick)
			continue;
		const int64_t segment[] = {present->session, present->branch, from->tick, from[1].tick};
		cau_status status = may_lose_log(database, segment, &may, error);
		if (status)
			return status;
		if (may)
			return open_gap(database, present, i, rows, error);
	}
	return CAU_OK;
}

static int64_t point_bytes(const struct cau_store_course *course)
{
	int64_t bytes = 0;
	for (int i = 0; i < course->point_count; i++)
		bytes += course->point[i].bytes;
	return bytes;
}

// Too big: first what was left, then checkpoints while they have more than half of the limit, then
// the oldest log.
static cau_status shrink(sqlite3 *database, const struct present *present, int64_t limit,
                         int64_t *rows, cau_error *error)
{
	cau_status status = trim_left(database, INT64_MAX, present->session, rows, error);
	if (status || *rows)
		return status;
	int dropped = cau_store_course_coarsen(&present->course, LEAST_SPACING_TICKS);
	if (dropped >= 0 && point_bytes(&present->course) > limit / 2)
		return drop_point(database, present->session, &present->course.point[dropped], rows, error);
	status = trim_log(database, present, rows, error);
	if (!status && !*rows && dropped >= 0)
		status =
			drop_point(database, present->session, &present->course.point[dropped], rows, error);
	return status;
}

static cau_status thin_session(sqlite3 *database, struct present *present, int64_t limit,
                               int64_t *rows, cau_error *error)
{
	cau_status status =
		cau_store_course_read(database, present->session, present->branch, &present->course, error);
	int dropped = status ? -1 : cau_store_course_thin(&present->course, LEAST_SPACING_TICKS);
	if (dropped >= 0)
		status =
			drop_point(database, present->session, &present->course.point[dropped], rows, error);
	else if (!status && present->bytes > limit)
		status = shrink(database, present, limit, rows, error);
	cau_store_course_finish(&present->course);
	return status;
}

// Sessions are tried in order until one can be made smaller.
static cau_status thin_sessions(sqlite3 *database, int64_t limit, int64_t *rows, cau_error *error)
{
	struct outcome found;
	for (int64_t after = 0; !*rows;) {
		cau_status status =
			run(database,
		        "SELECT s.key, s.branch, (SELECT sum(bytes) FROM branches WHERE session = s.key)"
		        " FROM sessions AS s WHERE s.deleted = 0 AND s.key > ?1 ORDER BY s.key LIMIT 1",
		        &after, &found, error);
		if (status || !found.rows)
			return status;
		struct present present = {found.value[0], found.value[1], found.value[2], {0}};
		after = present.session;
		status = thin_session(database, &present, limit, rows, error);
		if (status)
			return status;
	}
	return CAU_OK;
}

// A step of what trim_log has begun.
static cau_status empty_gaps(sqlite3 *database, int64_t *rows, cau_error *error)
{
	struct outcome gap, removed;
	cau_status status = run(
		database,
		"SELECT session, branch, from_tick, before_tick FROM gaps AS g WHERE trimmed = 1"
		" AND EXISTS(SELECT 1 FROM commands AS k WHERE k.session = g.session"
		"  AND k.branch = g.branch AND k.tick >= g.from_tick AND k.tick < g.before_tick) LIMIT 1",
		NULL, &gap, error);
	if (status || !gap.rows)
		return status;
	status = run(database,
	             "DELETE FROM commands WHERE session = ?1 AND branch = ?2 AND (tick, position) IN"
	             " (SELECT tick, position FROM commands WHERE session = ?1 AND branch = ?2"
	             "  AND tick >= ?3 AND tick < ?4 ORDER BY tick, position " STEP ")"
	             " RETURNING length(payload), tick",
	             gap.value, &removed, error);
	if (status)
		return status;
	*rows = removed.rows;
	return shrink_branch(database, gap.value[0], gap.value[1],
	                     removed.sum + removed.rows * ROW_BYTES, INT64_MAX, error);
}

// ---- the budget of the whole store -----------------------------------------------------
#define SPENT                                                                                      \
	"SELECT (SELECT coalesce(sum(bytes), 0) FROM branches)"                                        \
	" + (SELECT coalesce(sum(length(definition) + length(mesh)), 0) FROM sessions)"

// A present line's checkpoint, and how early it was written among all.
struct oldest {
	int64_t session, row;
	struct cau_store_point point;
};

static cau_status look_at_oldest(sqlite3 *database, const struct present *present,
                                 struct oldest *oldest, cau_error *error)
{
	struct outcome found;
	int index = cau_store_course_oldest(&present->course);
	if (index < 0)
		return CAU_OK;
	const struct cau_store_point *point = &present->course.point[index];
	cau_status status = run(
		database, "SELECT rowid FROM checkpoints WHERE session = ?1 AND branch = ?2 AND tick = ?3",
		(const int64_t[]){present->session, point->branch, point->tick}, &found, error);
	if (!status && found.rows && found.value[0] < oldest->row)
		*oldest = (struct oldest){present->session, found.value[0], *point};
	return status;
}

// Looks at each session's present line, the biggest session's first: for the oldest checkpoint, or,
// with `trim`, until one has given some of its log.
static cau_status walk(sqlite3 *database, bool trim, struct oldest *oldest, int64_t *rows,
                       cau_error *error)
{
	struct outcome found;
	for (int64_t nth = 0; !*rows; nth++) {
		cau_status status =
			run(database,
		        "SELECT s.key, s.branch, (SELECT sum(bytes) FROM branches WHERE session = s.key)"
		        " AS taken FROM sessions AS s WHERE s.deleted = 0 ORDER BY taken DESC, s.key"
		        " LIMIT 1 OFFSET ?1",
		        &nth, &found, error);
		if (status || !found.rows)
			return status;
		struct present present = {found.value[0], found.value[1], found.value[2], {0}};
		status = cau_store_course_read(database, present.session, present.branch, &present.course,
		                               error);
		if (!status)
			status = trim ? trim_log(database, &present, rows, error)
			              : look_at_oldest(database, &present, oldest, error);
		cau_store_course_finish(&present.course);
		if (status)
			return status;
	}
	return CAU_OK;
}

// What was left goes first, then of all sessions the checkpoint that was written first and may go,
// then the oldest log of the biggest session that has some to give.
static cau_status shrink_store(sqlite3 *database, struct cau_store_budget *budget, int64_t *rows,
                               cau_error *error)
{
	struct oldest oldest = {.row = INT64_MAX};
	cau_status status = trim_left(database, INT64_MAX, 0, rows, error);
	if (status || *rows)
		return status;
	status = walk(database, false, &oldest, rows, error);
	if (!status && oldest.row < INT64_MAX) {
		status = drop_point(database, oldest.session, &oldest.point, rows, error);
		budget->dropped += status ? 0 : *rows;
	} else if (!status) {
		status = walk(database, true, &oldest, rows, error);
	}
	return status;
}

static cau_status keep_budget(sqlite3 *database, int64_t most, struct cau_store_budget *budget,
                              int64_t *rows, cau_error *error)
{
	struct outcome spent;
	cau_status status = run(database, SPENT, NULL, &spent, error);
	if (status)
		return status;
	budget->bytes = spent.value[0];
	// Once beyond it, some room is made, so that not every checkpoint begins this anew.
	int64_t bound = budget->state == CAU_STORE_BUDGET_KEPT ? most : most - most / FREED_SHARE;
	if (!most || budget->bytes <= bound) {
		budget->state = CAU_STORE_BUDGET_KEPT;
		return CAU_OK;
	}
	status = shrink_store(database, budget, rows, error);
	budget->state = *rows                   ? CAU_STORE_BUDGET_SHRINKING
	                : budget->bytes <= most ? CAU_STORE_BUDGET_KEPT
	                                        : CAU_STORE_BUDGET_BEYOND;
	return status;
}

// ---- old answers and events -----------------------------------------------------------
static cau_status remove_old(sqlite3 *database, const char *sql, int64_t before_ms, int64_t *rows,
                             cau_error *error)
{
	struct outcome removed;
	cau_status status = run(database, sql, &before_ms, &removed, error);
	*rows = status ? 0 : removed.rows;
	return status;
}

#define OLD_ANSWERS "FROM answers WHERE time_ms < ?1 ORDER BY time_ms " STEP

// What is forgotten is remembered as such, so that a late resend does not act again.
static cau_status forget_answers(sqlite3 *database, int64_t before_ms, int64_t *rows,
                                 cau_error *error)
{
	struct outcome noted;
	cau_status status =
		run(database,
	        "INSERT INTO forgotten SELECT client, max(sequence), max(time_ms)"
	        " FROM (SELECT client, sequence, time_ms " OLD_ANSWERS ") WHERE true GROUP BY client"
	        " ON CONFLICT(client) DO UPDATE SET sequence = max(sequence, excluded.sequence),"
	        " time_ms = max(time_ms, excluded.time_ms)",
	        &before_ms, &noted, error);
	if (status)
		return status;
	return remove_old(database,
	                  "DELETE FROM answers WHERE (client, sequence) IN"
	                  " (SELECT client, sequence " OLD_ANSWERS ")",
	                  before_ms, rows, error);
}

static cau_status step(sqlite3 *database, const cau_store_config *config,
                       struct cau_store_budget *budget, int64_t *rows, cau_error *error)
{
	int64_t now_ms = config->wall_clock_ms();
	cau_status status = remove_deleted(database, rows, error);
	if (!status && !*rows)
		status = trim_left(database, now_ms - config->retention_age_ms, 0, rows, error);
	if (!status && !*rows)
		status = empty_gaps(database, rows, error);
	if (!status && !*rows)
		status = thin_sessions(database, config->retention_bytes, rows, error);
	if (!status && !*rows)
		status = keep_budget(database, config->store_bytes, budget, rows, error);
	if (!status && !*rows)
		status = forget_answers(database, now_ms - config->answer_age_ms, rows, error);
	if (!status && !*rows)
		status = remove_old(database,
		                    "DELETE FROM forgotten WHERE client IN (SELECT client FROM forgotten"
		                    " WHERE time_ms < ?1 " STEP ")",
		                    now_ms - config->event_age_ms, rows, error);
	// Events are written in the order of time, near enough: only the oldest keys need a look.
	if (!status && !*rows)
		status = remove_old(database,
		                    "DELETE FROM events WHERE key IN (SELECT key FROM (SELECT key, time_ms"
		                    " FROM events AS e WHERE NOT EXISTS(SELECT 1 FROM marks AS m"
		                    "  WHERE m.session = e.session AND m.branch = e.branch"
		                    "  AND m.tick = e.tick) ORDER BY key " STEP ") WHERE time_ms < ?1)",
		                    now_ms - config->event_age_ms, rows, error);
	return status;
}

cau_status cau_store_retention_step(sqlite3 *database, const cau_store_config *config,
                                    struct cau_store_budget *budget, int64_t *rows,
                                    cau_error *error)
{
	struct cau_store_budget next = *budget;
	*rows = 0;
	cau_status status = cau_store_execute(database, "BEGIN IMMEDIATE", "retention", error);
	if (!status)
		status = step(database, config, &next, rows, error);
	if (!status)
		status = cau_store_execute(database, "COMMIT", "retention", error);
	if (status && !sqlite3_get_autocommit(database))
		sqlite3_exec(database, "ROLLBACK", NULL, NULL, NULL);
	if (!status)
		*budget = next;
	return status;
}

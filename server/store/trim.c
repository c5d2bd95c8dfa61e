// SPDX-License-Identifier: GPL-3.0-or-later
#include "retention.h"

#include "file.h"

enum { ROW_BYTES = 64 }; // bytes that write.c counts for a command besides its payload

cau_status cau_store_run(sqlite3 *database, const char *sql, const int64_t *parameter,
                         struct cau_store_outcome *outcome, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	*outcome = (struct cau_store_outcome){.least = INT64_MAX};
	int code = sqlite3_prepare_v2(database, sql, -1, &statement, NULL);
	// The analyzer does not know the number of a statement's parameters.
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

// ---- left branches --------------------------------------------------------------------
static cau_status shrink_branch(sqlite3 *database, int64_t session, int64_t branch, int64_t bytes,
                                int64_t end_tick, cau_error *error)
{
	char sql[256];
	struct cau_store_outcome done;
	snprintf(sql, sizeof sql,
	         "UPDATE branches SET bytes = max(bytes - ?3, 0), end_tick = min(end_tick, %lld)"
	         " WHERE session = ?1 AND branch = ?2",
	         (long long)end_tick);
	return cau_store_run(database, sql, (const int64_t[]){session, branch, bytes}, &done, error);
}

// Takes one step on a branch from which everything after tick `keep` may be removed. keep = -1:
// everything may be removed, the branch itself too.
static cau_status trim_branch(sqlite3 *database, int64_t session, int64_t branch, int64_t keep,
                              int64_t *rows, cau_error *error)
{
	const int64_t parameter[] = {session, branch, keep};
	struct cau_store_outcome removed;
	// A checkpoint at the fork tick itself is shared, so it stays.
	cau_status status = cau_store_run(
		database,
		"DELETE FROM checkpoints WHERE rowid IN (SELECT rowid FROM checkpoints"
		" WHERE session = ?1 AND branch = ?2 AND tick > ?3 ORDER BY tick DESC LIMIT 1)"
		" RETURNING bytes, tick",
		parameter, &removed, error);
	removed.least = INT64_MAX; // a removed checkpoint does not shorten the log
	if (!status && !removed.rows) {
		status = cau_store_run(
			database,
			"DELETE FROM commands WHERE session = ?1 AND branch = ?2 AND (tick, position)"
			" IN (SELECT tick, position FROM commands WHERE session = ?1 AND branch = ?2"
			"  AND tick >= ?3 ORDER BY tick DESC, position DESC " CAU_STORE_ROWS ")"
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
	status = cau_store_run(database, "DELETE FROM branches WHERE session = ?1 AND branch = ?2",
	                       parameter, &removed, error);
	*rows = removed.rows;
	return status;
}

// Selects the branch that was left first and has something to remove, among those left by time ?1,
// of session ?2 or, if ?2 is 0, of any session.
#define LEFT_BRANCH                                                                                \
	"SELECT session, branch, keep FROM (SELECT session, branch, end_tick, left_ms,"                \
	" max(coalesce((SELECT max(fork_tick) FROM branches AS child"                                  \
	"  WHERE child.session = parent.session AND child.parent = parent.branch), -1),"               \
	"  coalesce((SELECT max(tick) FROM marks WHERE marks.session = parent.session"                 \
	"   AND marks.branch = parent.branch), -1)) AS keep"                                           \
	" FROM branches AS parent WHERE left_ms > 0 AND left_ms <= ?1 AND ?2 IN (0, session))"         \
	" WHERE end_tick > keep ORDER BY left_ms, branch LIMIT 1"

cau_status cau_store_trim_left(sqlite3 *database, int64_t left_before_ms, int64_t session,
                               int64_t *rows, cau_error *error)
{
	struct cau_store_outcome found;
	cau_status status = cau_store_run(database, LEFT_BRANCH,
	                                  (const int64_t[]){left_before_ms, session}, &found, error);
	while (!status && found.rows && !*rows) {
		status = trim_branch(database, found.value[0], found.value[1], found.value[2], rows, error);
		// the branch had nothing to remove, which is now recorded: search again
		if (!status && !*rows)
			status = cau_store_run(database, LEFT_BRANCH,
			                       (const int64_t[]){left_before_ms, session}, &found, error);
	}
	return status;
}

// ---- checkpoints and log of the present line ------------------------------------------
cau_status cau_store_drop_point(sqlite3 *database, int64_t session,
                                const struct cau_store_point *point, int64_t *rows,
                                cau_error *error)
{
	struct cau_store_outcome removed;
	cau_status status =
		cau_store_run(database,
	                  "DELETE FROM checkpoints WHERE session = ?1 AND branch = ?2 AND tick = ?3"
	                  " RETURNING bytes",
	                  (const int64_t[]){session, point->branch, point->tick}, &removed, error);
	if (status)
		return status;
	*rows += removed.rows;
	return shrink_branch(database, session, point->branch, removed.sum, INT64_MAX, error);
}

// Selects whether a segment of the line has log. A segment goes from the checkpoint at ?3 to the
// next one, at ?4.
#define SEGMENT_HAS_LOG                                                                            \
	CAU_STORE_LINE "SELECT 1 FROM line CROSS JOIN commands AS k ON k.session = ?1"                 \
				   " AND k.branch = line.branch AND k.tick >= max(?3, line.from_tick)"             \
				   " AND k.tick < min(?4, line.before_tick) LIMIT 1"

// Selects whether a segment must stay, because a marked state without a checkpoint is in it, or
// because another kept line forks from it.
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
	struct cau_store_outcome log, need;
	cau_status status = cau_store_run(database, SEGMENT_HAS_LOG, segment, &log, error);
	if (!status)
		status = cau_store_run(database, SEGMENT_IS_NEEDED, segment, &need, error);
	*may = !status && log.rows && !need.rows;
	return status;
}

// Records the segment as a gap, so that no rewind enters it after this transaction. Later steps
// remove its commands. If an older gap ends where the new gap begins, the older gap grows instead,
// and the checkpoint between the two is removed.
static cau_status open_gap(sqlite3 *database, const struct cau_store_present *present, int index,
                           int64_t *rows, cau_error *error)
{
	const struct cau_store_course *course = &present->course;
	const struct cau_store_point *from = &course->point[index];
	const int64_t segment[] = {present->session, present->branch, from->tick, from[1].tick};
	struct cau_store_outcome done;
	bool follows = false;
	for (int i = 0; i < course->hole_count; i++)
		follows |= course->hole[i].before_tick == from->tick;
	// An older gap that ends where the new gap begins is extended instead.
	cau_status status = cau_store_run(
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
		status = cau_store_drop_point(database, present->session, from, rows, error);
	return status;
}

cau_status cau_store_trim_log(sqlite3 *database, const struct cau_store_present *present,
                              int64_t *rows, cau_error *error)
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

cau_status cau_store_empty_gaps(sqlite3 *database, int64_t *rows, cau_error *error)
{
	struct cau_store_outcome gap, removed;
	cau_status status = cau_store_run(
		database,
		"SELECT session, branch, from_tick, before_tick FROM gaps AS g WHERE trimmed = 1"
		" AND EXISTS(SELECT 1 FROM commands AS k WHERE k.session = g.session"
		"  AND k.branch = g.branch AND k.tick >= g.from_tick AND k.tick < g.before_tick) LIMIT 1",
		NULL, &gap, error);
	if (status || !gap.rows)
		return status;
	status = cau_store_run(
		database,
		"DELETE FROM commands WHERE session = ?1 AND branch = ?2 AND (tick, position) IN"
		" (SELECT tick, position FROM commands WHERE session = ?1 AND branch = ?2"
		"  AND tick >= ?3 AND tick < ?4 ORDER BY tick, position " CAU_STORE_ROWS ")"
		" RETURNING length(payload), tick",
		gap.value, &removed, error);
	if (status)
		return status;
	*rows = removed.rows;
	return shrink_branch(database, gap.value[0], gap.value[1],
	                     removed.sum + removed.rows * ROW_BYTES, INT64_MAX, error);
}

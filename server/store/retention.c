// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses what to remove. Deleted sessions; parts of left branches from which no other branch was
// forked; old answers and events. On the present line: checkpoints that are close for their age
// (course.c), and the oldest log of a session that is too big. Marked states stay.
// A left branch loses its newest ticks first, so that the rest is always a complete beginning. The
// present line loses its log from the oldest on; the missing ranges are reported as gaps.
#include "retention.h"

#include <stdbool.h>

#include "file.h"

enum {
	// divisor of the budget: 1/20 of it is free after retention, once the budget was exceeded
	FREED_SHARE = 20,
	ANSWER_SHARE = 4,          // divisor of the budget: answers keep 1/4 if it is exceeded
	LEAST_SPACING_TICKS = 600, // smallest spacing of thinning: 10 s at 60 Hz, replayed in 3 s
};

// ---- deleted sessions -----------------------------------------------------------------
static cau_status remove_deleted(sqlite3 *database, int64_t *rows, cau_error *error)
{
	static const char *const removals[] = {
		"DELETE FROM answers WHERE (client, sequence) IN (SELECT a.client, a.sequence"
		" FROM sessions AS s JOIN moved AS m ON m.id = s.id JOIN answers AS a ON a.session = s.id"
		" WHERE s.key = ?1 AND s.deleted = 2 AND a.time_ms <= m.time_ms " CAU_STORE_ROWS ")",
		"DELETE FROM commands WHERE session = ?1 AND (branch, tick, position) IN"
		" (SELECT branch, tick, position FROM commands WHERE session = ?1 " CAU_STORE_ROWS ")",
		"DELETE FROM checkpoints WHERE rowid IN"
		" (SELECT rowid FROM checkpoints WHERE session = ?1 LIMIT 1)",
		"DELETE FROM events WHERE key IN (SELECT key FROM events WHERE session = ?1 " CAU_STORE_ROWS
		")",
		"DELETE FROM clients WHERE session = ?1 AND client IN"
		" (SELECT client FROM clients WHERE session = ?1 " CAU_STORE_ROWS ")",
		"DELETE FROM marks WHERE session = ?1",
		"DELETE FROM gaps WHERE session = ?1",
		"DELETE FROM branches WHERE session = ?1 AND branch IN"
		" (SELECT branch FROM branches WHERE session = ?1 " CAU_STORE_ROWS ")",
		"DELETE FROM sessions WHERE key = ?1",
	};
	struct cau_store_outcome found, removed = {0};
	cau_status status = cau_store_run(
		database, "SELECT key FROM sessions WHERE deleted > 0 LIMIT 1", NULL, &found, error);
	if (status || !found.rows)
		return status;
	for (size_t i = 0; i < sizeof removals / sizeof *removals && !status && !removed.rows; i++)
		status = cau_store_run(database, removals[i], found.value, &removed, error);
	*rows = removed.rows;
	return status;
}

// ---- a session ------------------------------------------------------------------------
static int64_t point_bytes(const struct cau_store_course *course)
{
	int64_t bytes = 0;
	for (int i = 0; i < course->point_count; i++)
		bytes += course->point[i].bytes;
	return bytes;
}

// Shrinks a session that is too big: first left branches, then checkpoints while they exceed half
// of the limit, then the oldest log.
static cau_status shrink(sqlite3 *database, const struct cau_store_present *present, int64_t limit,
                         int64_t *rows, cau_error *error)
{
	cau_status status = cau_store_trim_left(database, INT64_MAX, present->session, rows, error);
	if (status || *rows)
		return status;
	int dropped = cau_store_course_coarsen(&present->course, LEAST_SPACING_TICKS);
	if (dropped >= 0 && point_bytes(&present->course) > limit / 2)
		return cau_store_drop_point(database, present->session, &present->course.point[dropped],
		                            rows, error);
	status = cau_store_trim_log(database, present, rows, error);
	if (!status && !*rows && dropped >= 0)
		status = cau_store_drop_point(database, present->session, &present->course.point[dropped],
		                              rows, error);
	return status;
}

static cau_status thin_session(sqlite3 *database, struct cau_store_present *present, int64_t limit,
                               int64_t *rows, cau_error *error)
{
	cau_status status =
		cau_store_course_read(database, present->session, present->branch, &present->course, error);
	int dropped = status ? -1 : cau_store_course_thin(&present->course, LEAST_SPACING_TICKS);
	if (dropped >= 0)
		status = cau_store_drop_point(database, present->session, &present->course.point[dropped],
		                              rows, error);
	else if (!status && present->bytes > limit)
		status = shrink(database, present, limit, rows, error);
	cau_store_course_finish(&present->course);
	return status;
}

// Tries the sessions in order until one can be made smaller.
static cau_status thin_sessions(sqlite3 *database, int64_t limit, int64_t *rows, cau_error *error)
{
	struct cau_store_outcome found;
	for (int64_t after = 0; !*rows;) {
		cau_status status = cau_store_run(
			database,
			"SELECT s.key, s.branch, (SELECT sum(bytes) FROM branches WHERE session = s.key)"
			" FROM sessions AS s WHERE s.deleted = 0 AND s.key > ?1 ORDER BY s.key LIMIT 1",
			&after, &found, error);
		if (status || !found.rows)
			return status;
		struct cau_store_present present = {found.value[0], found.value[1], found.value[2], {0}};
		after = present.session;
		status = thin_session(database, &present, limit, rows, error);
		if (status)
			return status;
	}
	return CAU_OK;
}

// ---- old answers and events -----------------------------------------------------------
static cau_status remove_old(sqlite3 *database, const char *sql, int64_t before_ms, int64_t *rows,
                             cau_error *error)
{
	struct cau_store_outcome removed;
	cau_status status = cau_store_run(database, sql, &before_ms, &removed, error);
	*rows = status ? 0 : removed.rows;
	return status;
}

#define OLD_ANSWERS "FROM answers WHERE time_ms < ?1 ORDER BY time_ms " CAU_STORE_ROWS

// Removes old answers. It notes the newest sequence removed for each client, so that a late resend
// does not act again.
static cau_status forget_answers(sqlite3 *database, int64_t before_ms, int64_t *rows,
                                 cau_error *error)
{
	struct cau_store_outcome noted;
	cau_status status = cau_store_run(
		database,
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

#define OLD_FORGOTTEN                                                                              \
	"DELETE FROM forgotten WHERE client IN (SELECT client FROM forgotten"                          \
	" WHERE time_ms < ?1 ORDER BY time_ms " CAU_STORE_ROWS ")"

// SQL that removes old events. Events are written nearly in the order of time, so only the oldest
// keys are checked.
#define OLD_EVENTS                                                                                 \
	"DELETE FROM events WHERE key IN (SELECT key FROM (SELECT key, time_ms"                        \
	" FROM events AS e WHERE NOT EXISTS(SELECT 1 FROM marks AS m WHERE m.session = e.session"      \
	"  AND m.branch = e.branch AND m.tick = e.tick) ORDER BY key " CAU_STORE_ROWS                  \
	") WHERE time_ms < ?1)"

// ---- the budget of the whole store -----------------------------------------------------
// The bytes of all pages of the file that are in use, and so of every table and index.
#define SPENT                                                                                      \
	"SELECT (p.page_count - f.freelist_count) * s.page_size, (SELECT bytes FROM sizes)"            \
	" FROM pragma_page_count AS p, pragma_freelist_count AS f, pragma_page_size AS s"

// A checkpoint of a present line, with its session and its table row. A lower row was written
// earlier.
struct oldest {
	int64_t session, row;
	struct cau_store_point point;
};

static cau_status look_at_oldest(sqlite3 *database, const struct cau_store_present *present,
                                 struct oldest *oldest, cau_error *error)
{
	struct cau_store_outcome found;
	int index = cau_store_course_oldest(&present->course);
	if (index < 0)
		return CAU_OK;
	const struct cau_store_point *point = &present->course.point[index];
	cau_status status = cau_store_run(
		database, "SELECT rowid FROM checkpoints WHERE session = ?1 AND branch = ?2 AND tick = ?3",
		(const int64_t[]){present->session, point->branch, point->tick}, &found, error);
	if (!status && found.rows && found.value[0] < oldest->row)
		*oldest = (struct oldest){present->session, found.value[0], *point};
	return status;
}

// Visits each session's present line, the biggest session first. Finds the oldest checkpoint of all
// or, with `trim`, removes some of the log of the first session that can lose some.
static cau_status walk(sqlite3 *database, bool trim, struct oldest *oldest, int64_t *rows,
                       cau_error *error)
{
	struct cau_store_outcome found;
	for (int64_t nth = 0; !*rows; nth++) {
		cau_status status = cau_store_run(
			database,
			"SELECT s.key, s.branch, (SELECT sum(bytes) FROM branches WHERE session = s.key)"
			" AS taken FROM sessions AS s WHERE s.deleted = 0 ORDER BY taken DESC, s.key"
			" LIMIT 1 OFFSET ?1",
			&nth, &found, error);
		if (status || !found.rows)
			return status;
		struct cau_store_present present = {found.value[0], found.value[1], found.value[2], {0}};
		status = cau_store_course_read(database, present.session, present.branch, &present.course,
		                               error);
		if (!status)
			status = trim ? cau_store_trim_log(database, &present, rows, error)
			              : look_at_oldest(database, &present, oldest, error);
		cau_store_course_finish(&present.course);
		if (status)
			return status;
	}
	return CAU_OK;
}

// Removes the oldest removable checkpoint of all sessions. If there is none, removes the oldest log
// of the biggest session that can lose some.
static cau_status shrink_sessions(sqlite3 *database, struct cau_store_budget *budget, int64_t *rows,
                                  cau_error *error)
{
	struct oldest oldest = {.row = INT64_MAX};
	cau_status status = walk(database, false, &oldest, rows, error);
	if (!status && oldest.row < INT64_MAX) {
		status = cau_store_drop_point(database, oldest.session, &oldest.point, rows, error);
		budget->dropped += status ? 0 : *rows;
	} else if (!status) {
		status = walk(database, true, &oldest, rows, error);
	}
	return status;
}

// Removes, in this order: left branches, answers beyond their share, checkpoints and log of
// sessions, the other answers, events. A removed answer is still noted as forgotten, so that a late
// resend does not act again.
static cau_status shrink_store(sqlite3 *database, struct cau_store_budget *budget,
                               int64_t answer_bytes, int64_t most, int64_t *rows, cau_error *error)
{
	cau_status status = cau_store_trim_left(database, INT64_MAX, 0, rows, error);
	if (!status && !*rows && answer_bytes > most / ANSWER_SHARE)
		status = forget_answers(database, INT64_MAX, rows, error);
	if (!status && !*rows)
		status = shrink_sessions(database, budget, rows, error);
	if (!status && !*rows)
		status = forget_answers(database, INT64_MAX, rows, error);
	if (!status && !*rows)
		status = remove_old(database, OLD_EVENTS, INT64_MAX, rows, error);
	return status;
}

static cau_status keep_budget(sqlite3 *database, int64_t most, int64_t answer_bytes,
                              struct cau_store_budget *budget, int64_t *rows, cau_error *error)
{
	// Once the budget was exceeded, a twentieth of it is freed, so that not every new checkpoint
	// starts a removal.
	int64_t bound = budget->state == CAU_STORE_BUDGET_KEPT ? most : most - most / FREED_SHARE;
	if (!most || budget->bytes <= bound) {
		budget->state = CAU_STORE_BUDGET_KEPT;
		return CAU_OK;
	}
	cau_status status = shrink_store(database, budget, answer_bytes, most, rows, error);
	budget->state = *rows                   ? CAU_STORE_BUDGET_SHRINKING
	                : budget->bytes <= most ? CAU_STORE_BUDGET_KEPT
	                                        : CAU_STORE_BUDGET_BEYOND;
	return status;
}

static cau_status step(sqlite3 *database, const cau_store_config *config,
                       struct cau_store_budget *budget, int64_t *rows, cau_error *error)
{
	int64_t now_ms = config->wall_clock_ms();
	struct cau_store_outcome spent;
	cau_status status = cau_store_run(database, SPENT, NULL, &spent, error);
	budget->bytes = status ? budget->bytes : spent.value[0];
	if (!status)
		status = remove_deleted(database, rows, error);
	if (!status && !*rows)
		status = cau_store_trim_left(database, now_ms - config->retention_age_ms, 0, rows, error);
	if (!status && !*rows)
		status = cau_store_empty_gaps(database, rows, error);
	if (!status && !*rows)
		status = thin_sessions(database, config->retention_bytes, rows, error);
	if (!status && !*rows)
		status = keep_budget(database, config->store_bytes, spent.value[1], budget, rows, error);
	if (!status && !*rows)
		status = forget_answers(database, now_ms - config->answer_age_ms, rows, error);
	if (!status && !*rows)
		status = remove_old(database, OLD_FORGOTTEN, now_ms - config->event_age_ms, rows, error);
	if (!status && !*rows)
		status = remove_old(database, OLD_EVENTS, now_ms - config->event_age_ms, rows, error);
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

// SPDX-License-Identifier: GPL-3.0-or-later
// What may go: sessions that were deleted; of a branch that was left, what no other branch was
// forked from; checkpoints of a session that is too big, but for its newest two; old answers and
// events. Logs of the lines that are kept never go: without them nothing could be replayed.
//
// A branch loses its newest ticks first, so that what is left of it is always a whole beginning.
#include "retention.h"

#include "fault.h"

enum {
	ROWS_A_STEP = 256,
	CHECKPOINTS_KEPT = 2,
	ROW_BYTES = 64, // as write.c counts a command
};

// What a statement gave: rows, the sum and the least of its columns, and its last row.
struct outcome {
	int64_t rows;
	int64_t sum;      // of column 0
	int64_t least;    // of column 1
	int64_t value[3]; // of the last row
};

// Runs one statement with as many integers as it has parameters.
static cau_status run(sqlite3 *database, const char *sql, const int64_t *parameter,
                      struct outcome *outcome, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	*outcome = (struct outcome){.least = INT64_MAX};
	int code = sqlite3_prepare_v2(database, sql, -1, &statement, NULL);
	for (int i = 0; !code && i < sqlite3_bind_parameter_count(statement); i++)
		code = sqlite3_bind_int64(statement, i + 1, parameter[i]);
	while (!code && (code = sqlite3_step(statement)) == SQLITE_ROW) {
		code = SQLITE_OK;
		outcome->rows++;
		for (int i = 0; i < sqlite3_column_count(statement) && i < 3; i++)
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
	" coalesce((SELECT max(fork_tick) FROM branches AS child WHERE child.session = parent.session" \
	"  AND child.parent = parent.branch), -1) AS keep"                                             \
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

// ---- too big --------------------------------------------------------------------------
static cau_status thin_checkpoints(sqlite3 *database, int64_t session, int64_t *rows,
                                   cau_error *error)
{
	struct outcome oldest, removed;
	cau_status status =
		run(database, "SELECT count(*), branch, min(tick) FROM checkpoints WHERE session = ?1",
	        (const int64_t[]){session}, &oldest, error);
	if (status || oldest.value[0] <= CHECKPOINTS_KEPT)
		return status;
	int64_t branch = oldest.value[1];
	status = run(database,
	             "DELETE FROM checkpoints WHERE session = ?1 AND branch = ?2 AND tick = ?3"
	             " RETURNING bytes",
	             (const int64_t[]){session, branch, oldest.value[2]}, &removed, error);
	if (status)
		return status;
	*rows = removed.rows;
	return shrink_branch(database, session, branch, removed.sum, INT64_MAX, error);
}

static cau_status shrink_biggest(sqlite3 *database, int64_t limit, int64_t *rows, cau_error *error)
{
	struct outcome found;
	int64_t after = 0; // sessions are tried in order until one can be made smaller
	for (;;) {
		cau_status status = run(database,
		                        "SELECT session FROM branches WHERE session > ?2 GROUP BY session"
		                        " HAVING sum(bytes) > ?1 ORDER BY session LIMIT 1",
		                        (const int64_t[]){limit, after}, &found, error);
		if (status || !found.rows)
			return status;
		after = found.value[0];
		status = trim_left(database, INT64_MAX, after, rows, error);
		if (!status && !*rows)
			status = thin_checkpoints(database, after, rows, error);
		if (status || *rows)
			return status;
	}
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

static cau_status step(sqlite3 *database, const cau_store_config *config, int64_t *rows,
                       cau_error *error)
{
	int64_t now_ms = config->wall_clock_ms();
	cau_status status = remove_deleted(database, rows, error);
	if (!status && !*rows)
		status = trim_left(database, now_ms - config->retention_age_ms, 0, rows, error);
	if (!status && !*rows)
		status = shrink_biggest(database, config->retention_bytes, rows, error);
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
		                    " FROM events ORDER BY key " STEP ") WHERE time_ms < ?1)",
		                    now_ms - config->event_age_ms, rows, error);
	return status;
}

cau_status cau_store_retention_step(sqlite3 *database, const cau_store_config *config,
                                    int64_t *rows, cau_error *error)
{
	*rows = 0;
	cau_status status = cau_store_execute(database, "BEGIN IMMEDIATE", "retention", error);
	if (!status)
		status = step(database, config, rows, error);
	if (!status)
		status = cau_store_execute(database, "COMMIT", "retention", error);
	if (status && !sqlite3_get_autocommit(database))
		sqlite3_exec(database, "ROLLBACK", NULL, NULL, NULL);
	return status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "rows.h"

#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

#include "file.h"
#include "store_state.h"

// Notes of the records that were written: the last log entry of each branch, the hash of each
// checkpoint, and the last event and answer. They are kept in memory of the connection; the
// database itself is only read.
static const char notes[] =
	"PRAGMA temp_store = MEMORY;"
	"CREATE TEMP TABLE seen_line(branch INTEGER PRIMARY KEY, tick INTEGER, position INTEGER);"
	"CREATE TEMP TABLE seen_point(branch INTEGER, tick INTEGER, hash INTEGER,"
	" PRIMARY KEY(branch, tick)) WITHOUT ROWID;"
	"CREATE TEMP TABLE seen(event INTEGER, answer_ms INTEGER); INSERT INTO seen VALUES(0, 0);";

// Statements at the start and at the end of each reading. ?1: the session's key, ?2: its id.
static const char *const at_start[] = {
	"INSERT OR IGNORE INTO temp.seen_line SELECT branch, -1, -1 FROM branches WHERE session = ?1"};

static const char *const at_end[] = {
	"INSERT OR REPLACE INTO temp.seen_line SELECT l.branch, c.tick, c.position"
	" FROM temp.seen_line AS l JOIN commands AS c ON c.session = ?1 AND c.branch = l.branch"
	" WHERE (c.tick, c.position) = (SELECT tick, position FROM commands WHERE session = ?1"
	" AND branch = l.branch ORDER BY tick DESC, position DESC LIMIT 1)",
	"INSERT OR REPLACE INTO temp.seen_point SELECT branch, tick, hash FROM checkpoints"
	" WHERE session = ?1",
	"UPDATE temp.seen SET event = coalesce((SELECT max(key) FROM events WHERE session = ?1), "
	"event),"
	" answer_ms = max(0, coalesce((SELECT max(time_ms) FROM answers), answer_ms) - 5000)"};

// Columns: table, whether the second reading includes it, SQL. Answers of the last five seconds
// before the first reading ended are sent twice, because the wall clock may be set back a little.
// The other store ignores answers that it has.
#define DUMP_TABLE(X)                                                                              \
	X(SESSION, false, "SELECT state, created_ms, definition FROM sessions WHERE key = ?1")         \
	X(MESH, false, "SELECT mesh FROM sessions WHERE key = ?1")                                     \
	X(PRESENT, true, "SELECT state, branch FROM sessions WHERE key = ?1")                          \
	X(BRANCHES, true,                                                                              \
	  "SELECT branch, parent, fork_tick, opened_ms, left_ms, bytes, end_tick FROM branches"        \
	  " WHERE session = ?1 ORDER BY branch")                                                       \
	X(COMMANDS, true,                                                                              \
	  "SELECT c.branch, c.tick, c.position, c.kind, c.client, c.sequence, c.payload"               \
	  " FROM temp.seen_line AS l JOIN commands AS c ON c.session = ?1 AND c.branch = l.branch"     \
	  " AND (c.tick, c.position) > (l.tick, l.position)")                                          \
	X(CHECKPOINTS, true,                                                                           \
	  "SELECT branch, tick, hash, bytes, snapshot FROM checkpoints AS k WHERE session = ?1"        \
	  " AND NOT EXISTS (SELECT 1 FROM temp.seen_point AS p WHERE p.branch = k.branch"              \
	  " AND p.tick = k.tick AND p.hash = k.hash)")                                                 \
	X(EVENTS, true,                                                                                \
	  "SELECT branch, tick, level, time_ms, kind, text FROM events WHERE session = ?1"             \
	  " AND key > (SELECT event FROM temp.seen) ORDER BY key")                                     \
	X(CLIENTS, true, "SELECT client, sequence FROM clients WHERE session = ?1")                    \
	X(MARKS, true, "SELECT branch, tick FROM marks WHERE session = ?1")                            \
	X(GAPS, true, "SELECT branch, from_tick, before_tick, trimmed FROM gaps WHERE session = ?1")   \
	X(ANSWERS, true,                                                                               \
	  "SELECT client, sequence, time_ms, result FROM answers"                                      \
	  " WHERE time_ms >= (SELECT answer_ms FROM temp.seen) AND session = ?2")                      \
	X(FORGOTTEN, true,                                                                             \
	  "SELECT f.client, f.sequence, f.time_ms FROM clients AS c JOIN forgotten AS f"               \
	  " ON f.client = c.client WHERE c.session = ?1")

static const struct source {
	cau_rows_table table;
	bool grows;
	const char *sql;
} sources[] = {
#define X(table, grows, sql) {CAU_ROWS_##table, grows, sql},
	DUMP_TABLE(X)
#undef X
};

enum { SOURCE_COUNT = sizeof sources / sizeof *sources };

struct cau_store_dump {
	sqlite3 *database;
	sqlite3_stmt *statement; // statement of sources[at]; NULL: not begun
	int at;
	bool rest;
	int64_t key;
	char session[CAU_STORE_ID_BYTES];
};

static cau_status prepare(cau_store_dump *dump, const char *sql, sqlite3_stmt **statement,
                          cau_error *error)
{
	int code = sqlite3_prepare_v2(dump->database, sql, -1, statement, NULL);
	if (code)
		return cau_store_fault(dump->database, code, "reading a session", error);
	sqlite3_bind_int64(*statement, 1, dump->key);
	if (sqlite3_bind_parameter_count(*statement) > 1)
		sqlite3_bind_text(*statement, 2, dump->session, -1, SQLITE_STATIC);
	return CAU_OK;
}

static cau_status run_all(cau_store_dump *dump, const char *const *sql, size_t count,
                          cau_error *error)
{
	for (size_t i = 0; i < count; i++) {
		sqlite3_stmt *statement = NULL;
		cau_status status = prepare(dump, sql[i], &statement, error);
		int code = status ? SQLITE_OK : sqlite3_step(statement);
		if (!status && code != SQLITE_DONE)
			status = cau_store_fault(dump->database, code, "noting what was read", error);
		sqlite3_finalize(statement);
		if (status)
			return status;
	}
	return CAU_OK;
}

static cau_status begin(cau_store_dump *dump, cau_error *error)
{
	dump->at = 0;
	cau_status status = cau_store_execute(dump->database, "BEGIN", "reading a session", error);
	return status ? status : run_all(dump, at_start, sizeof at_start / sizeof *at_start, error);
}

static cau_status find_session(cau_store_dump *dump, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	int code =
		sqlite3_prepare_v2(dump->database, "SELECT key FROM sessions WHERE id = ?1 AND deleted = 0",
	                       -1, &statement, NULL);
	if (code)
		return cau_store_fault(dump->database, code, "reading a session", error);
	sqlite3_bind_text(statement, 1, dump->session, -1, SQLITE_STATIC);
	code = sqlite3_step(statement);
	if (code == SQLITE_ROW)
		dump->key = sqlite3_column_int64(statement, 0);
	sqlite3_finalize(statement);
	if (code == SQLITE_ROW)
		return CAU_OK;
	return code == SQLITE_DONE
	           ? cau_fail(error, CAU_NOT_FOUND, "session", "no session '%s'", dump->session)
	           : cau_store_fault(dump->database, code, "reading a session", error);
}

cau_status cau_store_dump_open(cau_store *store, const char *session, cau_store_dump **out,
                               cau_error *error)
{
	cau_store_dump *dump = calloc(1, sizeof *dump);
	if (!dump)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to read a session");
	snprintf(dump->session, sizeof dump->session, "%s", session);
	cau_status status = cau_store_file_open_reader(store->path, &dump->database, error);
	if (!status)
		status = find_session(dump, error);
	if (!status)
		status = cau_store_execute(dump->database, notes, "noting what was read", error);
	if (!status)
		status = begin(dump, error);
	if (status)
		cau_store_dump_close(dump);
	else
		*out = dump;
	return status;
}

static void put_row(sqlite3_stmt *statement, cau_rows_table table, cau_rows_writer *writer)
{
	cau_row row = {.table = table, .column_count = sqlite3_column_count(statement)};
	for (int i = 0; i < row.column_count; i++) {
		cau_column *column = &row.column[i];
		switch (sqlite3_column_type(statement, i)) {
		case SQLITE_INTEGER:
			column->type = CAU_COLUMN_INTEGER;
			column->integer = sqlite3_column_int64(statement, i);
			break;
		case SQLITE_TEXT:
			column->type = CAU_COLUMN_TEXT;
			column->bytes = (const char *)sqlite3_column_text(statement, i);
			break;
		case SQLITE_BLOB:
			column->type = CAU_COLUMN_BLOB;
			column->bytes = sqlite3_column_blob(statement, i);
			break;
		default:
			break;
		}
		if (column->type == CAU_COLUMN_TEXT || column->type == CAU_COLUMN_BLOB)
			column->byte_count = (size_t)sqlite3_column_bytes(statement, i);
	}
	cau_rows_put(writer, &row);
}

// Writes records from the present source until the writer is full or the source ends.
static cau_status write_some(cau_store_dump *dump, cau_rows_writer *writer, size_t bytes,
                             cau_error *error)
{
	const struct source *source = &sources[dump->at];
	cau_status status = CAU_OK;
	int code = SQLITE_ROW;
	if (!dump->statement)
		status = prepare(dump, source->sql, &dump->statement, error);
	while (!status && writer->byte_count < bytes && !writer->failed &&
	       (code = sqlite3_step(dump->statement)) == SQLITE_ROW)
		put_row(dump->statement, source->table, writer);
	if (!status && code == SQLITE_ROW)
		return CAU_OK;
	if (!status && code != SQLITE_DONE)
		status = cau_store_fault(dump->database, code, "reading a session", error);
	sqlite3_finalize(dump->statement);
	dump->statement = NULL;
	dump->at++;
	return status;
}

cau_status cau_store_dump_write(cau_store_dump *dump, cau_rows_writer *writer, size_t bytes,
                                bool *over, cau_error *error)
{
	cau_status status = CAU_OK;
	while (!status && dump->at < SOURCE_COUNT && writer->byte_count < bytes && !writer->failed) {
		if (dump->rest && !sources[dump->at].grows)
			dump->at++;
		else
			status = write_some(dump, writer, bytes, error);
	}
	if (!status && writer->failed)
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a piece of the session");
	*over = !status && dump->at == SOURCE_COUNT;
	if (!*over)
		return status;
	status = run_all(dump, at_end, sizeof at_end / sizeof *at_end, error);
	return status ? status
	              : cau_store_execute(dump->database, "COMMIT", "reading a session", error);
}

cau_status cau_store_dump_rest(cau_store_dump *dump, cau_error *error)
{
	dump->rest = true;
	return begin(dump, error);
}

void cau_store_dump_close(cau_store_dump *dump)
{
	if (!dump)
		return;
	sqlite3_finalize(dump->statement);
	sqlite3_close(dump->database);
	free(dump);
}

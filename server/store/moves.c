// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that move between stores: writes their records, and reads which sessions have moved
// away, have arrived, or are arriving.
#include "batch.h"

#include <stdio.h>
#include <string.h>

#include "file.h"
#include "rows.h"
#include "store_state.h"

// ---- writing ------------------------------------------------------------------------------------

// Statements that insert the records of a piece, by table. ?9 is the session's key. Records that
// arrive twice are replaced or kept, so that they are stored once. Records of the log and of events
// never arrive twice.
static const char *const inserts[CAU_ROWS_COUNT] = {
	[CAU_ROWS_MESH] = "UPDATE sessions SET mesh = ?1 WHERE key = ?9",
	[CAU_ROWS_PRESENT] = "UPDATE sessions SET state = ?1, branch = ?2 WHERE key = ?9",
	[CAU_ROWS_BRANCHES] = "INSERT OR REPLACE INTO branches(session, branch, parent, fork_tick,"
						  " opened_ms, left_ms, bytes, end_tick)"
						  " VALUES(?9, ?1, ?2, ?3, ?4, ?5, ?6, ?7)",
	[CAU_ROWS_COMMANDS] = "INSERT INTO commands VALUES(?9, ?1, ?2, ?3, ?4, ?5, ?6, ?7)",
	[CAU_ROWS_CHECKPOINTS] = "INSERT OR REPLACE INTO checkpoints VALUES(?9, ?1, ?2, ?3, ?4, ?5)",
	[CAU_ROWS_EVENTS] = "INSERT INTO events(session, branch, tick, level, time_ms, kind, text)"
						" VALUES(?9, ?1, ?2, ?3, ?4, ?5, ?6)",
	[CAU_ROWS_CLIENTS] = "INSERT OR REPLACE INTO clients VALUES(?9, ?1, ?2)",
	[CAU_ROWS_MARKS] = "INSERT OR IGNORE INTO marks VALUES(?9, ?1, ?2)",
	[CAU_ROWS_GAPS] = "INSERT OR REPLACE INTO gaps VALUES(?9, ?1, ?2, ?3, ?4)",
	// If this client's sequence was already answered here, that answer stays.
	[CAU_ROWS_ANSWERS] = "INSERT OR IGNORE INTO answers SELECT ?1, ?2, ?3, id, ?4 FROM sessions"
						 " WHERE key = ?9",
	[CAU_ROWS_FORGOTTEN] = "INSERT INTO forgotten SELECT ?1, ?2, ?3 WHERE ?9 ON CONFLICT(client)"
						   " DO UPDATE SET sequence = max(sequence, excluded.sequence),"
						   " time_ms = max(time_ms, excluded.time_ms)"};

static const char add_session[] =
	"INSERT INTO sessions(id, name, state, branch, created_ms, definition, mesh)"
	" VALUES(?8, ?7, ?1, 0, ?2, ?3, x'')";

// ---- statements -----------------------------------------------------------------------
static cau_status prepare(sqlite3 *database, const char *sql, sqlite3_stmt **statement,
                          cau_error *error)
{
	int code = sqlite3_prepare_v2(database, sql, -1, statement, NULL);
	return code ? cau_store_fault(database, code, "a session that moves", error) : CAU_OK;
}

static cau_status run(sqlite3 *database, sqlite3_stmt *statement, cau_error *error)
{
	int code = sqlite3_step(statement);
	cau_status status = code == SQLITE_DONE
	                        ? CAU_OK
	                        : cau_store_fault(database, code, "a session that moves", error);
	sqlite3_reset(statement);
	sqlite3_clear_bindings(statement);
	return status;
}

// Runs one statement. Binds the texts to ?1, ?2, ... up to a NULL, then `now_ms` to ?9 and `number`
// to ?8.
static cau_status run_texts(sqlite3 *database, const char *sql, const char *const *texts,
                            int64_t number, int64_t now_ms, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = prepare(database, sql, &statement, error);
	if (status)
		return status;
	for (int i = 0; texts[i]; i++)
		sqlite3_bind_text(statement, i + 1, texts[i], -1, SQLITE_STATIC);
	if (sqlite3_bind_parameter_count(statement) >= 8)
		sqlite3_bind_int64(statement, 8, number);
	if (sqlite3_bind_parameter_count(statement) >= 9)
		sqlite3_bind_int64(statement, 9, now_ms);
	status = run(database, statement, error);
	sqlite3_finalize(statement);
	return status;
}

// ---- records of a piece ---------------------------------------------------------------
static void bind_row(sqlite3_stmt *statement, const cau_row *row)
{
	for (int i = 0; i < row->column_count; i++) {
		const cau_column *column = &row->column[i];
		if (column->type == CAU_COLUMN_INTEGER)
			sqlite3_bind_int64(statement, i + 1, column->integer);
		else if (column->type == CAU_COLUMN_TEXT)
			sqlite3_bind_text64(statement, i + 1, column->bytes, column->byte_count, SQLITE_STATIC,
			                    SQLITE_UTF8);
		else if (column->type == CAU_COLUMN_BLOB)
			sqlite3_bind_blob64(statement, i + 1, column->byte_count ? column->bytes : "",
			                    column->byte_count, SQLITE_STATIC);
	}
}

struct importing {
	sqlite3 *database;
	const char *id;
	char name[CAU_STORE_ID_BYTES];
	int64_t key; // key of the session; 0: not known yet
	// first: the piece has the head of a move; made: the piece created the session
	bool first, made;
	sqlite3_stmt *statement[CAU_ROWS_COUNT];
};

static cau_status find_key(struct importing *to, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = prepare(
		to->database, "SELECT key FROM sessions WHERE id = ?1 AND deleted = 0", &statement, error);
	if (status)
		return status;
	sqlite3_bind_text(statement, 1, to->id, -1, SQLITE_STATIC);
	int code = sqlite3_step(statement);
	if (code == SQLITE_ROW)
		to->key = sqlite3_column_int64(statement, 0);
	else if (code == SQLITE_DONE)
		status = cau_fail(error, CAU_NOT_FOUND, "session", "no session '%s'", to->id);
	else
		status = cau_store_fault(to->database, code, "a session that moves", error);
	sqlite3_finalize(statement);
	return status;
}

static cau_status make_session(struct importing *to, const cau_row *row, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = prepare(to->database, add_session, &statement, error);
	if (status)
		return status;
	bind_row(statement, row);
	sqlite3_bind_text(statement, 7, *to->name ? to->name : to->id, -1, SQLITE_STATIC);
	sqlite3_bind_text(statement, 8, to->id, -1, SQLITE_STATIC);
	status = run(to->database, statement, error);
	sqlite3_finalize(statement);
	if (status == CAU_ALREADY_EXISTS)
		return cau_fail(error, status, "id", "session '%s' exists already", to->id);
	if (status)
		return status;
	to->key = sqlite3_last_insert_rowid(to->database);
	to->made = true;
	return CAU_OK;
}

static cau_status put_row(struct importing *to, const cau_row *row, cau_error *error)
{
	cau_status status = CAU_OK;
	sqlite3_stmt **statement = &to->statement[row->table];
	if (row->table == CAU_ROWS_HEADER) {
		to->first = true;
		cau_rows_text(row, 4, to->name, sizeof to->name);
	}
	if (row->table == CAU_ROWS_SESSION)
		return make_session(to, row, error);
	if (!inserts[row->table]) // the head of the move and the rows of some tables are not stored
		return CAU_OK;
	if (!to->key)
		status = find_key(to, error);
	if (!status && !*statement)
		status = prepare(to->database, inserts[row->table], statement, error);
	if (status)
		return status;
	bind_row(*statement, row);
	sqlite3_bind_int64(*statement, 9, to->key);
	status = run(to->database, *statement, error);
	if (status == CAU_ALREADY_EXISTS)
		return cau_fail(error, CAU_BAD_VALUE, "rows", "a record of the session is there twice");
	return status;
}

static cau_status put_rows(sqlite3 *database, const struct record *record, cau_error *error)
{
	struct importing to = {.database = database, .id = record->as.rows.id};
	const cau_store_bytes *piece = &record->as.rows.piece;
	cau_rows_reader reader;
	cau_row row;
	cau_status status = cau_rows_open(&reader, piece->data, piece->bytes, error);
	bool all_read = false;
	while (!status && !all_read) {
		status = cau_rows_next(&reader, &row, error);
		all_read = status == CAU_NOT_FOUND;
		if (!status)
			status = put_row(&to, &row, error);
	}
	for (int i = 0; i < CAU_ROWS_COUNT; i++)
		sqlite3_finalize(to.statement[i]);
	// the error is the piece's; the store is sound
	if (status == CAU_CORRUPT || status == CAU_UNSUPPORTED)
		status = cau_fail(error, CAU_BAD_VALUE, "rows", "the piece of the session is damaged");
	if (!all_read)
		return status;
	if (to.first && !to.made)
		return cau_fail(error, CAU_BAD_VALUE, "rows", "the first piece of a move has no session");
	return to.key ? CAU_OK : find_key(&to, error);
}

// ---- records of the moves themselves --------------------------------------------------
static cau_status take_out(sqlite3 *database, const cau_store_moved *moved, int64_t now_ms,
                           cau_error *error)
{
	const char *const id[] = {moved->id, NULL};
	const char *const row[] = {moved->id,  moved->move,  moved->target, moved->label,
	                           moved->url, moved->proof, NULL};
	cau_status status = run_texts(
		database, "UPDATE sessions SET deleted = 2 WHERE id = ?1 AND deleted = 0", id, 0, 0, error);
	if (!status && sqlite3_changes(database) == 0)
		return cau_fail(error, CAU_NOT_FOUND, "session", "no session '%s'", moved->id);
	if (!status)
		status = run_texts(database, "DELETE FROM arrivals WHERE id = ?1", id, 0, 0, error);
	return status ? status
	              : run_texts(database,
	                          "INSERT OR REPLACE INTO moved"
	                          " VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?9)",
	                          row, 0, now_ms, error);
}

static cau_status put_arrival(sqlite3 *database, const cau_store_arrival *arrival, int64_t now_ms,
                              cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	const char *const id[] = {arrival->id, NULL};
	cau_status status = prepare(database,
	                            "INSERT OR REPLACE INTO arrivals"
	                            " VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)",
	                            &statement, error);
	if (status)
		return status;
	const char *const texts[] = {arrival->id, arrival->move, arrival->lock, arrival->source,
	                             arrival->label};
	for (int i = 0; i < 5; i++)
		sqlite3_bind_text(statement, i + 1, texts[i], -1, SQLITE_STATIC);
	sqlite3_bind_int64(statement, 6, arrival->pieces);
	sqlite3_bind_int64(statement, 7, arrival->state);
	sqlite3_bind_int64(statement, 8, now_ms);
	sqlite3_bind_text(statement, 9, arrival->unlock ? arrival->unlock : "", -1, SQLITE_STATIC);
	sqlite3_bind_text(statement, 10, arrival->seal ? arrival->seal : "", -1, SQLITE_STATIC);
	status = run(database, statement, error);
	sqlite3_finalize(statement);
	if (!status) // a session that returns brings its answers; answers that are still here stay
		status =
			run_texts(database, "UPDATE sessions SET deleted = 1 WHERE id = ?1 AND deleted = 2", id,
		              0, 0, error);
	if (!status && arrival->state == CAU_STORE_ACCEPTED)
		status = run_texts(database, "DELETE FROM moved WHERE id = ?1", id, 0, 0, error);
	return status;
}

static cau_status forget_arrival(sqlite3 *database, const cau_store_arrival *arrival,
                                 cau_error *error)
{
	const char *const id[] = {arrival->id, NULL};
	cau_status status = run_texts(
		database, "UPDATE sessions SET deleted = 1 WHERE id = ?1 AND deleted = 0", id, 0, 0, error);
	return status ? status
	              : run_texts(database, "DELETE FROM arrivals WHERE id = ?1", id, 0, 0, error);
}

cau_status cau_store_import(sqlite3 *database, const struct record *record, int64_t now_ms,
                            cau_error *error)
{
	switch (record->kind) {
	case RECORD_MOVED:
		return take_out(database, &record->as.moved, now_ms, error);
	case RECORD_ARRIVAL:
		return put_arrival(database, &record->as.arrival, now_ms, error);
	case RECORD_ARRIVAL_FORGET:
		return forget_arrival(database, &record->as.arrival, error);
	case RECORD_ROWS:
		return put_rows(database, record, error);
	default:
		return cau_fail(error, CAU_BAD_VALUE, NULL, "a record of unknown kind");
	}
}

// ---- reading ------------------------------------------------------------------------------------

cau_status cau_store_read_moved(cau_store *store, cau_store_visit_moved visit, void *user,
                                cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	cau_status visited = CAU_OK;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_prepare(
		reader, "SELECT id, move, target, label, url, proof, time_ms FROM moved ORDER BY id",
		&statement, error);
	while (!status && !visited && !(status = cau_store_next_row(reader, statement, error))) {
		cau_store_moved moved = {.id = cau_store_column_text(statement, 0),
		                         .move = cau_store_column_text(statement, 1),
		                         .target = cau_store_column_text(statement, 2),
		                         .label = cau_store_column_text(statement, 3),
		                         .url = cau_store_column_text(statement, 4),
		                         .proof = cau_store_column_text(statement, 5),
		                         .time_ms = sqlite3_column_int64(statement, 6)};
		visited = visit(user, &moved);
	}
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return visited ? visited : cau_store_end_is_fine(status);
}

cau_status cau_store_read_arrivals(cau_store *store, cau_store_visit_arrival visit, void *user,
                                   cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	cau_status visited = CAU_OK;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_prepare(
		reader,
		"SELECT id, move, lock, source, label, pieces, state, time_ms, unlock, seal FROM arrivals"
		" ORDER BY id",
		&statement, error);
	while (!status && !visited && !(status = cau_store_next_row(reader, statement, error))) {
		cau_store_arrival arrival = {.id = cau_store_column_text(statement, 0),
		                             .move = cau_store_column_text(statement, 1),
		                             .lock = cau_store_column_text(statement, 2),
		                             .source = cau_store_column_text(statement, 3),
		                             .label = cau_store_column_text(statement, 4),
		                             .pieces = sqlite3_column_int64(statement, 5),
		                             .state =
		                                 (cau_store_arrival_state)sqlite3_column_int(statement, 6),
		                             .time_ms = sqlite3_column_int64(statement, 7),
		                             .unlock = cau_store_column_text(statement, 8),
		                             .seal = cau_store_column_text(statement, 9)};
		visited = visit(user, &arrival);
	}
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return visited ? visited : cau_store_end_is_fine(status);
}

cau_status cau_store_move_secret(cau_store *store, char secret[65], cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_prepare(reader, "SELECT value FROM secrets WHERE name = 'move'",
	                                      &statement, error);
	if (!status)
		status = cau_store_next_row(reader, statement, error);
	if (!status)
		snprintf(secret, 65, "%s", cau_store_column_text(statement, 0));
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Synchronous reads, on connections of their own. In WAL mode they neither wait for commits nor
// delay them. Stored answers have a connection for themselves, so that a worker that looks for an
// answer never waits for the builder's reading of a log.
#include <stdlib.h>
#include <string.h>

#include "file.h"
#include "store_state.h"

enum {
	PIECE_ROWS = 256,      // most commands in one piece
	PIECE_BYTES = 1 << 20, // approximate limit of the bytes of commands in one piece
	// largest number of branches from a branch to its root; more means damage
	MAX_DEPTH = 100000,
};

// ---- small pieces ---------------------------------------------------------------------
cau_status cau_store_prepare(struct cau_store_reader *reader, const char *sql,
                             sqlite3_stmt **statement, cau_error *error)
{
	int code = sqlite3_prepare_v2(reader->database, sql, -1, statement, NULL);
	return code ? cau_store_fault(reader->database, code, "reading", error) : CAU_OK;
}

cau_status cau_store_next_row(struct cau_store_reader *reader, sqlite3_stmt *statement,
                              cau_error *error)
{
	int code = sqlite3_step(statement);
	if (code == SQLITE_ROW)
		return CAU_OK;
	return code == SQLITE_DONE ? CAU_NOT_FOUND
	                           : cau_store_fault(reader->database, code, "reading", error);
}

cau_status cau_store_end_is_fine(cau_status status)
{
	return status == CAU_NOT_FOUND ? CAU_OK : status;
}

static cau_store_bytes column_blob(sqlite3_stmt *statement, int column)
{
	cau_store_bytes blob = {.data = sqlite3_column_blob(statement, column)};
	blob.bytes = (size_t)sqlite3_column_bytes(statement, column);
	return blob;
}

const char *cau_store_column_text(sqlite3_stmt *statement, int column)
{
	return (const char *)sqlite3_column_text(statement, column);
}

cau_status cau_store_find_session(struct cau_store_reader *reader, const char *id, int64_t *key,
                                  cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = cau_store_prepare(
		reader, "SELECT key FROM sessions WHERE id = ?1 AND deleted = 0", &statement, error);
	if (!status) {
		sqlite3_bind_text(statement, 1, id, -1, SQLITE_STATIC);
		status = cau_store_next_row(reader, statement, error);
	}
	if (!status)
		*key = sqlite3_column_int64(statement, 0);
	else if (status == CAU_NOT_FOUND)
		cau_fail(error, status, "session", "no session '%s'", id);
	sqlite3_finalize(statement);
	return status;
}

cau_status cau_store_read_generation(cau_store *store, char text[CAU_STORE_ID_BYTES],
                                     cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	*text = 0;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_prepare(
		reader, "SELECT value FROM meta WHERE name = 'generation'", &statement, error);
	if (!status)
		status = cau_store_next_row(reader, statement, error);
	if (!status)
		snprintf(text, CAU_STORE_ID_BYTES, "%s", cau_store_column_text(statement, 0));
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return cau_store_end_is_fine(status);
}

// ---- sessions -------------------------------------------------------------------------
static void fill_session(sqlite3_stmt *statement, cau_store_session *session)
{
	session->id = cau_store_column_text(statement, 0);
	session->name = cau_store_column_text(statement, 1);
	session->state = cau_store_column_text(statement, 2);
	session->branch = sqlite3_column_int64(statement, 3);
	session->created_ms = sqlite3_column_int64(statement, 4);
	session->definition = column_blob(statement, 5);
	session->mesh = column_blob(statement, 6);
}

cau_status cau_store_read_sessions(cau_store *store, cau_store_visit_session visit, void *user,
                                   cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	cau_store_session session;
	pthread_mutex_lock(&reader->mutex);
	cau_status status =
		cau_store_prepare(reader,
	                      "SELECT id, name, state, branch, created_ms, definition, x''"
	                      " FROM sessions WHERE deleted = 0 ORDER BY key",
	                      &statement, error);
	cau_status visited = CAU_OK;
	while (!status && !visited && !(status = cau_store_next_row(reader, statement, error))) {
		fill_session(statement, &session);
		visited = visit(user, &session);
	}
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return visited ? visited : cau_store_end_is_fine(status);
}

cau_status cau_store_read_session(cau_store *store, const char *id, cau_store_visit_session visit,
                                  void *user, cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	cau_store_session session;
	pthread_mutex_lock(&reader->mutex);
	cau_status status =
		cau_store_prepare(reader,
	                      "SELECT id, name, state, branch, created_ms, definition, mesh"
	                      " FROM sessions WHERE id = ?1 AND deleted = 0",
	                      &statement, error);
	if (!status) {
		sqlite3_bind_text(statement, 1, id, -1, SQLITE_STATIC);
		status = cau_store_next_row(reader, statement, error);
		if (status == CAU_NOT_FOUND)
			cau_fail(error, status, "session", "no session '%s'", id);
	}
	if (!status) {
		fill_session(statement, &session);
		status = visit(user, &session);
	}
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return status;
}

// ---- branches, clients --------------------------------------------------------
cau_status cau_store_read_branches(cau_store *store, const char *session,
                                   cau_store_visit_branch visit, void *user, cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	int64_t key;
	cau_status visited = CAU_OK;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_find_session(reader, session, &key, error);
	cau_status found = status;
	if (!status)
		status = cau_store_prepare(reader,
		                           "SELECT branch, parent, fork_tick, opened_ms, left_ms, end_tick"
		                           " FROM branches WHERE session = ?1 ORDER BY branch",
		                           &statement, error);
	if (!status)
		sqlite3_bind_int64(statement, 1, key);
	while (!status && !visited && !(status = cau_store_next_row(reader, statement, error))) {
		cau_store_branch branch = {
			.session = session,
			.branch = sqlite3_column_int64(statement, 0),
			.parent = sqlite3_column_int64(statement, 1),
			.fork_tick = (uint64_t)sqlite3_column_int64(statement, 2),
			.opened_ms = sqlite3_column_int64(statement, 3),
			.left_ms = sqlite3_column_int64(statement, 4),
			.end_tick = (uint64_t)sqlite3_column_int64(statement, 5),
		};
		visited = visit(user, &branch);
	}
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return found ? found : visited ? visited : cau_store_end_is_fine(status);
}

cau_status cau_store_read_clients(cau_store *store, const char *session,
                                  cau_store_visit_client visit, void *user, cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	int64_t key;
	cau_status visited = CAU_OK;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_find_session(reader, session, &key, error);
	cau_status found = status;
	if (!status)
		status = cau_store_prepare(
			reader, "SELECT client, sequence FROM clients WHERE session = ?1 ORDER BY client",
			&statement, error);
	if (!status)
		sqlite3_bind_int64(statement, 1, key);
	while (!status && !visited && !(status = cau_store_next_row(reader, statement, error)))
		visited = visit(user, cau_store_column_text(statement, 0),
		                (uint64_t)sqlite3_column_int64(statement, 1));
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return found ? found : visited ? visited : cau_store_end_is_fine(status);
}

// ---- the line of a branch -------------------------------------------------------------
// Finds the branch's parent (-1: none) and fork tick. Returns CAU_NOT_FOUND if there is no such
// branch.
static cau_status find_branch(struct cau_store_reader *reader, int64_t key, int64_t branch,
                              int64_t *parent, int64_t *fork_tick, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = cau_store_prepare(
		reader, "SELECT parent, fork_tick FROM branches WHERE session = ?1 AND branch = ?2",
		&statement, error);
	if (!status) {
		sqlite3_bind_int64(statement, 1, key);
		sqlite3_bind_int64(statement, 2, branch);
		status = cau_store_next_row(reader, statement, error);
	}
	if (status == CAU_NOT_FOUND)
		cau_fail(error, status, "branch", "no branch %lld", (long long)branch);
	if (!status) {
		*parent = sqlite3_column_int64(statement, 0);
		*fork_tick = sqlite3_column_int64(statement, 1);
	}
	sqlite3_finalize(statement);
	return status;
}

cau_status cau_store_find_line(struct cau_store_reader *reader, int64_t key, int64_t branch,
                               struct cau_store_stretch **line, int *count, cau_error *error)
{
	int64_t before_tick = INT64_MAX, parent = -1;
	int capacity = 0;
	*line = NULL;
	*count = 0;
	for (; branch >= 0; branch = parent) {
		if (*count == MAX_DEPTH)
			return cau_fail(error, CAU_CORRUPT, NULL, "the branches form a cycle");
		if (*count == capacity) {
			capacity = capacity ? 2 * capacity : 16;
			struct cau_store_stretch *grown = realloc(*line, (size_t)capacity * sizeof **line);
			if (!grown)
				return cau_fail(error, CAU_NO_MEMORY, NULL, "%d branches", capacity);
			*line = grown;
		}
		struct cau_store_stretch *stretch = &(*line)[*count];
		cau_status status = find_branch(reader, key, branch, &parent, &stretch->from_tick, error);
		if (status)
			return status;
		stretch->branch = branch;
		stretch->before_tick = before_tick;
		before_tick = stretch->from_tick;
		++*count;
	}
	return CAU_OK;
}

cau_status cau_store_read_checkpoint(cau_store *store, const char *session, int64_t branch,
                                     uint64_t tick, cau_store_visit_checkpoint visit, void *user,
                                     cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	struct cau_store_stretch *line = NULL;
	int count = 0;
	int64_t key, newest = tick < INT64_MAX ? (int64_t)tick : INT64_MAX;
	cau_store_checkpoint checkpoint = {.session = session};
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_find_session(reader, session, &key, error);
	if (!status)
		status = cau_store_find_line(reader, key, branch, &line, &count, error);
	if (!status)
		status = cau_store_prepare(reader,
		                           "SELECT tick, hash, snapshot FROM checkpoints WHERE session = ?1"
		                           " AND branch = ?2 AND tick <= ?3 ORDER BY tick DESC LIMIT 1",
		                           &statement, error);
	if (status)
		goto out;
	status = CAU_NOT_FOUND;
	for (int i = 0; i < count && status == CAU_NOT_FOUND; i++) {
		if (line[i].before_tick < newest)
			newest = line[i].before_tick; // a parent's checkpoint at the fork tick itself is shared
		checkpoint.branch = line[i].branch;
		sqlite3_reset(statement);
		sqlite3_bind_int64(statement, 1, key);
		sqlite3_bind_int64(statement, 2, line[i].branch);
		sqlite3_bind_int64(statement, 3, newest);
		status = cau_store_next_row(reader, statement, error);
	}
	if (status == CAU_NOT_FOUND)
		cau_fail(error, status, "tick", "no checkpoint at or before tick %llu",
		         (unsigned long long)tick);
	if (status)
		goto out;
	checkpoint.tick = (uint64_t)sqlite3_column_int64(statement, 0);
	checkpoint.hash = (uint64_t)sqlite3_column_int64(statement, 1);
	checkpoint.snapshot = column_blob(statement, 2);
	status = visit(user, &checkpoint);
out:
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	free(line);
	return status;
}

// ---- the log --------------------------------------------------------------------------
// The start of the next piece of a stretch.
struct cursor {
	int64_t tick, position;
};

// Copies one piece of a stretch into `piece` and moves the cursor behind it. *more: there may be
// another piece.
static cau_status read_piece(struct cau_store_reader *reader, int64_t key, const char *session,
                             const struct cau_store_stretch *stretch, struct cursor *cursor,
                             cau_store_batch *piece, bool *more, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	int rows = 0;
	cau_status status = cau_store_prepare(reader,
	                                      "SELECT tick, position, kind, client, sequence, payload"
	                                      " FROM commands WHERE session = ?1 AND branch = ?2"
	                                      " AND (tick, position) >= (?3, ?4) AND tick < ?5"
	                                      " ORDER BY tick, position LIMIT 256",
	                                      &statement, error);
	const int64_t parameter[] = {key, stretch->branch, cursor->tick, cursor->position,
	                             stretch->before_tick};
	for (int i = 0; !status && i < 5; i++)
		sqlite3_bind_int64(statement, i + 1, parameter[i]);
	while (!status && cau_store_batch_bytes(piece) < PIECE_BYTES) {
		status = cau_store_next_row(reader, statement, error);
		if (status)
			break;
		cau_store_command command = {
			.session = session,
			.branch = stretch->branch,
			.tick = (uint64_t)sqlite3_column_int64(statement, 0),
			.order = (uint32_t)sqlite3_column_int64(statement, 1),
			.kind = sqlite3_column_int(statement, 2),
			.client = cau_store_column_text(statement, 3),
			.sequence = (uint64_t)sqlite3_column_int64(statement, 4),
			.payload = column_blob(statement, 5),
		};
		cursor->tick = (int64_t)command.tick;
		cursor->position = (int64_t)command.order + 1;
		rows++;
		status = cau_store_put_command(piece, &command, error);
	}
	*more = status != CAU_NOT_FOUND || rows == PIECE_ROWS;
	sqlite3_finalize(statement);
	return cau_store_end_is_fine(status);
}

static cau_status read_stretch(struct cau_store_reader *reader, int64_t key, const char *session,
                               const struct cau_store_stretch *stretch,
                               cau_store_visit_command visit, void *user, cau_error *error)
{
	struct cursor cursor = {stretch->from_tick, 0};
	cau_status status = CAU_OK;
	for (bool more = true; more && !status;) {
		cau_store_batch *piece = cau_store_batch_create();
		if (!piece)
			return cau_fail(error, CAU_NO_MEMORY, NULL, "reading the log");
		pthread_mutex_lock(&reader->mutex);
		status = read_piece(reader, key, session, stretch, &cursor, piece, &more, error);
		pthread_mutex_unlock(&reader->mutex);
		for (const struct record *record = piece->first; record && !status; record = record->next)
			status = visit(user, &record->as.command);
		cau_store_batch_destroy(piece);
	}
	return status;
}

cau_status cau_store_read_log(cau_store *store, const char *session, int64_t branch,
                              uint64_t from_tick, uint64_t before_tick,
                              cau_store_visit_command visit, void *user, cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	struct cau_store_stretch *line = NULL;
	int count = 0;
	int64_t key;
	int64_t from = from_tick < INT64_MAX ? (int64_t)from_tick : INT64_MAX;
	int64_t before = before_tick < INT64_MAX ? (int64_t)before_tick : INT64_MAX;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_find_session(reader, session, &key, error);
	if (!status)
		status = cau_store_find_line(reader, key, branch, &line, &count, error);
	pthread_mutex_unlock(&reader->mutex);
	for (int i = count - 1; i >= 0 && !status; i--) {
		if (line[i].from_tick < from)
			line[i].from_tick = from;
		if (line[i].before_tick > before)
			line[i].before_tick = before;
		if (line[i].from_tick < line[i].before_tick)
			status = read_stretch(reader, key, session, &line[i], visit, user, error);
	}
	free(line);
	return status;
}

// ---- answers --------------------------------------------------------------------------
// True if the batch or one after it answers the client's request `sequence`. The caller holds the
// queue's mutex.
static bool list_answers(const struct cau_store_batch *batch, const char *client, uint64_t sequence)
{
	for (; batch; batch = batch->next) {
		for (const struct record *record = batch->first; record; record = record->next) {
			const char *name;
			uint64_t number;
			if (cau_store_record_request(record, &name, &number) && number == sequence &&
			    strcmp(name, client) == 0)
				return true;
		}
	}
	return false;
}

static bool is_pending(struct cau_store_queue *queue, const char *client, uint64_t sequence)
{
	pthread_mutex_lock(&queue->mutex);
	bool pending = list_answers(queue->committing, client, sequence) ||
	               list_answers(queue->first, client, sequence);
	pthread_mutex_unlock(&queue->mutex);
	return pending;
}

// Returns why there is no answer: CAU_ALREADY_EXISTS if the answer is forgotten, else
// CAU_NOT_FOUND.
static cau_status look_for_forgotten(struct cau_store_reader *reader, const char *client,
                                     uint64_t sequence, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = cau_store_prepare(
		reader, "SELECT 1 FROM forgotten WHERE client = ?1 AND sequence >= ?2", &statement, error);
	if (!status) {
		sqlite3_bind_text(statement, 1, client, -1, SQLITE_STATIC);
		sqlite3_bind_int64(statement, 2, (int64_t)sequence);
		status = cau_store_next_row(reader, statement, error);
	}
	sqlite3_finalize(statement);
	if (status == CAU_NOT_FOUND)
		return cau_fail(error, status, "sequence", "there is no answer to request %llu of '%s'",
		                (unsigned long long)sequence, client);
	if (status)
		return status;
	return cau_fail(error, CAU_ALREADY_EXISTS, "sequence",
	                "the answer to request %llu of '%s' is not kept any more",
	                (unsigned long long)sequence, client);
}

cau_status cau_store_read_answer(cau_store *store, const char *client, uint64_t sequence,
                                 cau_store_visit_answer visit, void *user, cau_error *error)
{
	struct cau_store_reader *reader = &store->answers;
	sqlite3_stmt *statement = NULL;
	// The queue is checked first: a batch that leaves the queue after the check is in the database.
	if (is_pending(&store->queue, client, sequence))
		return cau_fail(error, CAU_BAD_STATE, "sequence", "request %llu is being stored",
		                (unsigned long long)sequence);
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_prepare(
		reader, "SELECT session, result FROM answers WHERE client = ?1 AND sequence = ?2",
		&statement, error);
	if (!status) {
		sqlite3_bind_text(statement, 1, client, -1, SQLITE_STATIC);
		sqlite3_bind_int64(statement, 2, (int64_t)sequence);
		status = cau_store_next_row(reader, statement, error);
	}
	if (status == CAU_NOT_FOUND)
		status = look_for_forgotten(reader, client, sequence, error);
	if (!status) {
		cau_store_answer answer = {
			.client = client,
			.sequence = sequence,
			.session = cau_store_column_text(statement, 0),
			.result = column_blob(statement, 1),
		};
		status = visit(user, &answer);
	}
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return status;
}

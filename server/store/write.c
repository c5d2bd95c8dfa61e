// SPDX-License-Identifier: GPL-3.0-or-later
#include "batch.h"

#include "cautery/assert.h"
#include "file.h"

// Columns: name, SQL.
#define STATEMENT_TABLE(X)                                                                         \
	X(FIND_SESSION, "SELECT key FROM sessions WHERE id = ?1 AND deleted = 0")                      \
	X(ADD_SESSION, "INSERT INTO sessions(id, name, state, branch, created_ms, definition, mesh)"   \
	               " VALUES(?1, ?2, ?3, 0, ?4, ?5, ?6)")                                           \
	X(SET_STATE, "UPDATE sessions SET state = ?2 WHERE key = ?1")                                  \
	X(DELETE_SESSION, "UPDATE sessions SET deleted = 1 WHERE key = ?1")                            \
	X(ADD_BRANCH, "INSERT INTO branches(session, branch, parent, fork_tick, opened_ms)"            \
	              " VALUES(?1, ?2, ?3, ?4, ?5)")                                                   \
	X(FIND_BRANCH, "SELECT parent, fork_tick, end_tick FROM branches"                              \
	               " WHERE session = ?1 AND branch = ?2")                                          \
	X(LEAVE_BRANCH, "UPDATE branches SET left_ms = ?2 WHERE session = ?1 AND branch ="             \
	                " (SELECT branch FROM sessions WHERE key = ?1)")                               \
	X(TAKE_BRANCH, "UPDATE sessions SET branch = ?2 WHERE key = ?1")                               \
	X(GROW_BRANCH, "UPDATE branches SET bytes = bytes + ?3 WHERE session = ?1 AND branch = ?2")    \
	X(ADD_COMMAND, "INSERT INTO commands VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)")                  \
	X(FORGET_REACHED,                                                                              \
	  "DELETE FROM commands WHERE kind = -1 AND session = ?1 AND branch = ?2"                      \
	  " AND (tick, position) = (SELECT tick, position FROM commands WHERE session = ?1"            \
	  " AND branch = ?2 ORDER BY tick DESC, position DESC LIMIT 1)")                               \
	X(ADD_ANSWER, "INSERT INTO answers VALUES(?1, ?2, ?3, ?4, ?5)")                                \
	X(SEE_CLIENT, "INSERT INTO clients VALUES(?1, ?2, ?3) ON CONFLICT(session, client)"            \
	              " DO UPDATE SET sequence = max(sequence, excluded.sequence)")                    \
	X(FIND_CHECKPOINT, "SELECT bytes FROM checkpoints"                                             \
	                   " WHERE session = ?1 AND branch = ?2 AND tick = ?3")                        \
	X(ADD_CHECKPOINT, "INSERT OR REPLACE INTO checkpoints VALUES(?1, ?2, ?3, ?4, ?5, ?6)")         \
	X(ADD_EVENT, "INSERT INTO events(session, tick, level, time_ms, kind, text, branch)"           \
	             " VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)")                                            \
	X(FORGET_EVENTS, "DELETE FROM events WHERE session = ?1 AND branch = ?2 AND tick > ?3")        \
	X(ADD_MARK, "INSERT OR IGNORE INTO marks VALUES(?1, ?2, ?3)")                                  \
	X(ADD_GAP,                                                                                     \
	  "INSERT INTO gaps VALUES(?1, ?2, ?3, ?4, 0) ON CONFLICT(session, branch, from_tick)"         \
	  " DO UPDATE SET before_tick = max(before_tick, excluded.before_tick)")                       \
	X(SET_GENERATION, "REPLACE INTO meta VALUES('generation', ?1)")

enum statement_index {
#define X(name, sql) name,
	STATEMENT_TABLE(X)
#undef X
		STATEMENT_COUNT
};
_Static_assert((int)STATEMENT_COUNT == (int)CAU_STORE_STATEMENTS, "one slot per statement");

static const char *const statement_sql[] = {
#define X(name, sql) sql,
	STATEMENT_TABLE(X)
#undef X
};

enum {
	ROW_BYTES = 64,         // approximate bytes of a table row besides its payload
	UNCOUNTED_BYTES = 4096, // most bytes of a branch that are not counted yet: a page of the log
};

cau_status cau_store_writer_init(struct cau_store_writer *writer, sqlite3 *database,
                                 cau_error *error)
{
	*writer = (struct cau_store_writer){.database = database};
	for (int i = 0; i < STATEMENT_COUNT; i++) {
		int code = sqlite3_prepare_v3(database, statement_sql[i], -1, SQLITE_PREPARE_PERSISTENT,
		                              &writer->statement[i], NULL);
		if (code) {
			cau_status status = cau_store_fault(database, code, "the tables", error);
			cau_store_writer_finish(writer);
			return status;
		}
	}
	return CAU_OK;
}

void cau_store_writer_finish(struct cau_store_writer *writer)
{
	for (int i = 0; i < STATEMENT_COUNT; i++)
		sqlite3_finalize(writer->statement[i]);
	*writer = (struct cau_store_writer){0};
}

// ---- binding --------------------------------------------------------------------------
// Results of binding are ignored. A statement with a wrong binding fails in sqlite3_step, with
// SQLITE_MISUSE or with a NULL in a NOT NULL column.

static void bind_text(sqlite3_stmt *statement, int index, const char *text)
{
	sqlite3_bind_text(statement, index, text, -1, SQLITE_STATIC);
}

static void bind_blob(sqlite3_stmt *statement, int index, cau_store_bytes blob)
{
	// A NULL pointer would store NULL instead of an empty blob.
	sqlite3_bind_blob64(statement, index, blob.bytes ? blob.data : "", blob.bytes, SQLITE_STATIC);
}

static void bind_count(sqlite3_stmt *statement, int index, uint64_t value)
{
	sqlite3_bind_int64(statement, index, (int64_t)value);
}

// Runs a statement that returns no rows of a table.
static cau_status run(struct cau_store_writer *writer, enum statement_index index, const char *what,
                      cau_error *error)
{
	sqlite3_stmt *statement = writer->statement[index];
	int code = sqlite3_step(statement);
	cau_status status =
		code == SQLITE_DONE ? CAU_OK : cau_store_fault(writer->database, code, what, error);
	sqlite3_reset(statement);
	sqlite3_clear_bindings(statement);
	return status;
}

// Runs a statement that returns at most one table row, of up to three integers.
static cau_status look(struct cau_store_writer *writer, enum statement_index index, bool *found,
                       int64_t value[3], cau_error *error)
{
	sqlite3_stmt *statement = writer->statement[index];
	int code = sqlite3_step(statement);
	cau_status status = CAU_OK;
	*found = code == SQLITE_ROW;
	if (*found) {
		for (int i = 0; i < 3 && i < sqlite3_column_count(statement); i++)
			value[i] = sqlite3_column_int64(statement, i);
	} else if (code != SQLITE_DONE) {
		status = cau_store_fault(writer->database, code, "looking up", error);
	}
	sqlite3_reset(statement);
	sqlite3_clear_bindings(statement);
	return status;
}

static cau_status find_session(struct cau_store_writer *writer, const char *id, int64_t *key,
                               cau_error *error)
{
	bool found;
	int64_t value[3] = {0};
	bind_text(writer->statement[FIND_SESSION], 1, id);
	cau_status status = look(writer, FIND_SESSION, &found, value, error);
	if (status)
		return status;
	if (!found)
		return cau_fail(error, CAU_NOT_FOUND, "session", "no session '%s'", id);
	*key = value[0];
	return CAU_OK;
}

// Adds bytes to a branch's count. The branch must exist.
static cau_status grow_branch(struct cau_store_writer *writer, int64_t key, int64_t branch,
                              int64_t bytes, cau_error *error)
{
	sqlite3_stmt *statement = writer->statement[GROW_BRANCH];
	sqlite3_bind_int64(statement, 1, key);
	sqlite3_bind_int64(statement, 2, branch);
	sqlite3_bind_int64(statement, 3, bytes);
	cau_status status = run(writer, GROW_BRANCH, "a branch", error);
	if (!status && sqlite3_changes(writer->database) == 0)
		return cau_fail(error, CAU_NOT_FOUND, "branch", "no branch %lld", (long long)branch);
	return status;
}

static cau_status check_branch(struct cau_store_writer *writer, int64_t key, int64_t branch,
                               cau_error *error)
{
	bool found;
	int64_t value[3];
	sqlite3_bind_int64(writer->statement[FIND_BRANCH], 1, key);
	sqlite3_bind_int64(writer->statement[FIND_BRANCH], 2, branch);
	cau_status status = look(writer, FIND_BRANCH, &found, value, error);
	if (!status && !found)
		return cau_fail(error, CAU_NOT_FOUND, "branch", "no branch %lld", (long long)branch);
	return status;
}

// Adds a slot's bytes to its branch. Retention may have removed the branch meanwhile.
static cau_status count_slot(struct cau_store_writer *writer, int index, cau_error *error)
{
	int64_t key = writer->uncounted.slot[index].key;
	int64_t branch = writer->uncounted.slot[index].branch;
	cau_status status =
		grow_branch(writer, key, branch, writer->uncounted.slot[index].bytes, error);
	if (status && status != CAU_NOT_FOUND)
		return status;
	writer->uncounted.slot[index].bytes = 0;
	return CAU_OK;
}

// Finds the branch's slot, or else a free one. If all slots are in use, the fullest is counted and
// freed first.
static cau_status find_slot(struct cau_store_writer *writer, int64_t key, int64_t branch,
                            int *index, cau_error *error)
{
	struct cau_store_uncounted *all = &writer->uncounted;
	int unused = -1, fullest = 0;
	for (int i = 0; i < CAU_STORE_UNCOUNTED_SLOTS; i++) {
		*index = i;
		if (all->slot[i].bytes == 0)
			unused = i;
		else if (all->slot[i].key == key && all->slot[i].branch == branch)
			return CAU_OK;
		if (all->slot[i].bytes > all->slot[fullest].bytes)
			fullest = i;
	}
	*index = unused < 0 ? fullest : unused;
	cau_status status = unused < 0 ? count_slot(writer, fullest, error) : CAU_OK;
	if (!status) {
		all->slot[*index].key = key;
		all->slot[*index].branch = branch;
	}
	return status;
}

// Notes the bytes of a command, to count them later with others of the same branch. The branch must
// exist.
static cau_status count_later(struct cau_store_writer *writer, int64_t key, int64_t branch,
                              int64_t bytes, cau_error *error)
{
	int index;
	CAU_ASSERT(bytes > 0, "a command of %lld bytes", (long long)bytes);
	cau_status status = check_branch(writer, key, branch, error);
	if (!status)
		status = find_slot(writer, key, branch, &index, error);
	if (status)
		return status;
	writer->uncounted.slot[index].bytes += bytes;
	if (writer->uncounted.slot[index].bytes < UNCOUNTED_BYTES)
		return CAU_OK;
	return count_slot(writer, index, error);
}

// ---- records --------------------------------------------------------------------------
static cau_status add_branch(struct cau_store_writer *writer, int64_t key, int64_t branch,
                             int64_t parent, uint64_t fork_tick, int64_t now_ms, cau_error *error)
{
	sqlite3_stmt *statement = writer->statement[ADD_BRANCH];
	sqlite3_bind_int64(statement, 1, key);
	sqlite3_bind_int64(statement, 2, branch);
	sqlite3_bind_int64(statement, 3, parent);
	bind_count(statement, 4, fork_tick);
	sqlite3_bind_int64(statement, 5, now_ms);
	return run(writer, ADD_BRANCH, "a branch", error);
}

static cau_status apply_session(struct cau_store_writer *writer, const cau_store_session *session,
                                int64_t now_ms, cau_error *error)
{
	int64_t created_ms = session->created_ms ? session->created_ms : now_ms;
	sqlite3_stmt *statement = writer->statement[ADD_SESSION];
	bind_text(statement, 1, session->id);
	bind_text(statement, 2, session->name);
	bind_text(statement, 3, session->state);
	sqlite3_bind_int64(statement, 4, created_ms);
	bind_blob(statement, 5, session->definition);
	bind_blob(statement, 6, session->mesh);
	cau_status status = run(writer, ADD_SESSION, "a session", error);
	if (status == CAU_ALREADY_EXISTS)
		return cau_fail(error, status, "id", "session '%s' exists already", session->id);
	if (status)
		return status;
	int64_t key = sqlite3_last_insert_rowid(writer->database);
	return add_branch(writer, key, 0, -1, 0, created_ms, error);
}

static cau_status apply_session_state(struct cau_store_writer *writer,
                                      const cau_store_session *session, cau_error *error)
{
	int64_t key;
	cau_status status = find_session(writer, session->id, &key, error);
	if (status)
		return status;
	sqlite3_bind_int64(writer->statement[SET_STATE], 1, key);
	bind_text(writer->statement[SET_STATE], 2, session->state);
	return run(writer, SET_STATE, "a session's state", error);
}

static cau_status apply_session_delete(struct cau_store_writer *writer,
                                       const cau_store_session *session, cau_error *error)
{
	int64_t key;
	cau_status status = find_session(writer, session->id, &key, error);
	if (status)
		return status;
	sqlite3_bind_int64(writer->statement[DELETE_SESSION], 1, key);
	return run(writer, DELETE_SESSION, "deleting a session", error);
}

static cau_status apply_answer(struct cau_store_writer *writer, const cau_store_answer *answer,
                               int64_t now_ms, cau_error *error)
{
	sqlite3_stmt *statement = writer->statement[ADD_ANSWER];
	bind_text(statement, 1, answer->client);
	bind_count(statement, 2, answer->sequence);
	sqlite3_bind_int64(statement, 3, now_ms);
	bind_text(statement, 4, answer->session);
	bind_blob(statement, 5, answer->result);
	cau_status status = run(writer, ADD_ANSWER, "an answer", error);
	if (status == CAU_ALREADY_EXISTS)
		return cau_fail(error, status, "sequence", "request %llu of '%s' has already been answered",
		                (unsigned long long)answer->sequence, answer->client);
	return status;
}

// Records a command's answer, and its client among the session's clients.
static cau_status apply_request(struct cau_store_writer *writer, int64_t key,
                                const cau_store_command *command, int64_t now_ms, cau_error *error)
{
	cau_store_answer answer = {command->client, command->sequence, command->session,
	                           command->result};
	cau_status status = apply_answer(writer, &answer, now_ms, error);
	if (status)
		return status;
	sqlite3_stmt *statement = writer->statement[SEE_CLIENT];
	sqlite3_bind_int64(statement, 1, key);
	bind_text(statement, 2, command->client);
	bind_count(statement, 3, command->sequence);
	return run(writer, SEE_CLIENT, "a client", error);
}

// Removes the log's last entry if both this entry and the new entry are of kind CAU_STORE_REACHED.
// *taken: an entry was removed. The new entry replaces it, so the branch's bytes stay the same.
static cau_status take_place(struct cau_store_writer *writer, int64_t key,
                             const cau_store_command *command, bool *taken, cau_error *error)
{
	*taken = false;
	if (command->kind != CAU_STORE_REACHED)
		return CAU_OK;
	sqlite3_bind_int64(writer->statement[FORGET_REACHED], 1, key);
	sqlite3_bind_int64(writer->statement[FORGET_REACHED], 2, command->branch);
	cau_status status = run(writer, FORGET_REACHED, "an entry of the log", error);
	*taken = !status && sqlite3_changes(writer->database) > 0;
	return status;
}

static cau_status apply_command(struct cau_store_writer *writer, const cau_store_command *command,
                                int64_t now_ms, cau_error *error)
{
	int64_t key;
	bool taken;
	cau_status status = find_session(writer, command->session, &key, error);
	if (!status)
		status = take_place(writer, key, command, &taken, error);
	if (!status && !taken)
		status = count_later(writer, key, command->branch,
		                     (int64_t)command->payload.bytes + ROW_BYTES, error);
	if (status)
		return status;
	sqlite3_stmt *statement = writer->statement[ADD_COMMAND];
	sqlite3_bind_int64(statement, 1, key);
	sqlite3_bind_int64(statement, 2, command->branch);
	bind_count(statement, 3, command->tick);
	sqlite3_bind_int64(statement, 4, command->order);
	sqlite3_bind_int(statement, 5, command->kind);
	if (command->client) {
		bind_text(statement, 6, command->client);
		bind_count(statement, 7, command->sequence);
	}
	bind_blob(statement, 8, command->payload);
	status = run(writer, ADD_COMMAND, "a command", error);
	if (status == CAU_ALREADY_EXISTS)
		return cau_fail(error, status, "order", "command %u of tick %llu is logged", command->order,
		                (unsigned long long)command->tick);
	if (status || !command->client)
		return status;
	return apply_request(writer, key, command, now_ms, error);
}

static cau_status apply_checkpoint(struct cau_store_writer *writer,
                                   const cau_store_checkpoint *checkpoint, cau_error *error)
{
	int64_t key, replaced[3] = {0}, bytes = (int64_t)checkpoint->snapshot.bytes + ROW_BYTES;
	bool found;
	cau_status status = find_session(writer, checkpoint->session, &key, error);
	if (status)
		return status;
	sqlite3_stmt *find = writer->statement[FIND_CHECKPOINT];
	sqlite3_bind_int64(find, 1, key);
	sqlite3_bind_int64(find, 2, checkpoint->branch);
	bind_count(find, 3, checkpoint->tick);
	status = look(writer, FIND_CHECKPOINT, &found, replaced, error);
	if (!status)
		status = grow_branch(writer, key, checkpoint->branch, bytes - replaced[0], error);
	if (status)
		return status;
	sqlite3_stmt *add = writer->statement[ADD_CHECKPOINT];
	sqlite3_bind_int64(add, 1, key);
	sqlite3_bind_int64(add, 2, checkpoint->branch);
	bind_count(add, 3, checkpoint->tick);
	bind_count(add, 4, checkpoint->hash);
	sqlite3_bind_int64(add, 5, bytes);
	bind_blob(add, 6, checkpoint->snapshot);
	return run(writer, ADD_CHECKPOINT, "a checkpoint", error);
}

static cau_status apply_event(struct cau_store_writer *writer, const cau_store_event *event,
                              int64_t now_ms, cau_error *error)
{
	int64_t key = 0;
	cau_status status = event->session ? find_session(writer, event->session, &key, error) : CAU_OK;
	if (status)
		return status;
	sqlite3_stmt *statement = writer->statement[ADD_EVENT];
	sqlite3_bind_int64(statement, 1, key);
	bind_count(statement, 2, event->tick);
	sqlite3_bind_int(statement, 3, event->level);
	sqlite3_bind_int64(statement, 4, event->time_ms ? event->time_ms : now_ms);
	bind_text(statement, 5, event->kind);
	bind_text(statement, 6, event->text);
	sqlite3_bind_int64(statement, 7, event->branch);
	return run(writer, ADD_EVENT, "an event", error);
}

static cau_status apply_forget(struct cau_store_writer *writer, const cau_store_event *after,
                               cau_error *error)
{
	int64_t key;
	cau_status status = find_session(writer, after->session, &key, error);
	if (status)
		return status;
	sqlite3_stmt *statement = writer->statement[FORGET_EVENTS];
	sqlite3_bind_int64(statement, 1, key);
	sqlite3_bind_int64(statement, 2, after->branch);
	bind_count(statement, 3, after->tick);
	return run(writer, FORGET_EVENTS, "events", error);
}

static cau_status apply_gap(struct cau_store_writer *writer, const struct record *record,
                            cau_error *error)
{
	const cau_store_gap *gap = &record->as.gap;
	enum statement_index index = record->kind == RECORD_GAP ? ADD_GAP : ADD_MARK;
	sqlite3_stmt *statement = writer->statement[index];
	int64_t key;
	cau_status status = find_session(writer, gap->session, &key, error);
	if (status)
		return status;
	sqlite3_bind_int64(statement, 1, key);
	sqlite3_bind_int64(statement, 2, gap->branch);
	bind_count(statement, 3, gap->from_tick);
	if (index == ADD_GAP)
		bind_count(statement, 4, gap->before_tick);
	return run(writer, index, index == ADD_GAP ? "a gap" : "a mark", error);
}

// Goes from *parent towards the root until the branch that owns the states up to fork_tick.
static cau_status find_owner(struct cau_store_writer *writer, int64_t key, uint64_t fork_tick,
                             int64_t *parent, cau_error *error)
{
	for (;;) {
		bool found;
		int64_t up[3] = {0}; // parent, fork tick, end tick
		sqlite3_bind_int64(writer->statement[FIND_BRANCH], 1, key);
		sqlite3_bind_int64(writer->statement[FIND_BRANCH], 2, *parent);
		cau_status status = look(writer, FIND_BRANCH, &found, up, error);
		if (status)
			return status;
		if (!found)
			return cau_fail(error, CAU_NOT_FOUND, "parent", "no branch %lld", (long long)*parent);
		if ((int64_t)fork_tick > up[2])
			return cau_fail(error, CAU_NOT_FOUND, "fork_tick",
			                "the log of branch %lld from tick %lld on has been removed",
			                (long long)*parent, (long long)up[2]);
		if (up[0] < 0 || (int64_t)fork_tick > up[1])
			return CAU_OK;
		*parent = up[0];
	}
}

static cau_status apply_branch(struct cau_store_writer *writer, const cau_store_branch *branch,
                               int64_t now_ms, cau_error *error)
{
	int64_t key, parent = branch->parent;
	cau_status status = find_session(writer, branch->session, &key, error);
	if (!status)
		status = find_owner(writer, key, branch->fork_tick, &parent, error);
	if (!status)
		status = add_branch(writer, key, branch->branch, parent, branch->fork_tick, now_ms, error);
	if (status == CAU_ALREADY_EXISTS)
		return cau_fail(error, status, "branch", "branch %lld exists already",
		                (long long)branch->branch);
	if (status)
		return status;
	sqlite3_bind_int64(writer->statement[LEAVE_BRANCH], 1, key);
	sqlite3_bind_int64(writer->statement[LEAVE_BRANCH], 2, now_ms);
	status = run(writer, LEAVE_BRANCH, "leaving a branch", error);
	if (status)
		return status;
	sqlite3_bind_int64(writer->statement[TAKE_BRANCH], 1, key);
	sqlite3_bind_int64(writer->statement[TAKE_BRANCH], 2, branch->branch);
	return run(writer, TAKE_BRANCH, "taking a branch", error);
}

cau_status cau_store_writer_apply(struct cau_store_writer *writer, const struct record *record,
                                  int64_t now_ms, cau_error *error)
{
	switch (record->kind) {
	case RECORD_SESSION:
		return apply_session(writer, &record->as.session, now_ms, error);
	case RECORD_SESSION_STATE:
		return apply_session_state(writer, &record->as.session, error);
	case RECORD_SESSION_DELETE:
		return apply_session_delete(writer, &record->as.session, error);
	case RECORD_COMMAND:
		return apply_command(writer, &record->as.command, now_ms, error);
	case RECORD_ANSWER:
		return apply_answer(writer, &record->as.answer, now_ms, error);
	case RECORD_CHECKPOINT:
		return apply_checkpoint(writer, &record->as.checkpoint, error);
	case RECORD_EVENT:
		return apply_event(writer, &record->as.event, now_ms, error);
	case RECORD_EVENTS_FORGET:
		return apply_forget(writer, &record->as.event, error);
	case RECORD_BRANCH:
		return apply_branch(writer, &record->as.branch, now_ms, error);
	case RECORD_MARK:
	case RECORD_GAP:
		return apply_gap(writer, record, error);
	case RECORD_MOVED:
	case RECORD_ARRIVAL:
	case RECORD_ARRIVAL_FORGET:
	case RECORD_ROWS:
		return cau_store_import(writer->database, record, now_ms, error);
	case RECORD_GENERATION:
		bind_text(writer->statement[SET_GENERATION], 1, record->as.generation);
		return run(writer, SET_GENERATION, "the generation", error);
	}
	return cau_fail(error, CAU_BAD_VALUE, NULL, "a record of unknown kind");
}

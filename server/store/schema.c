// SPDX-License-Identifier: GPL-3.0-or-later
#include "file.h"

#include <stdint.h>

#include "batch.h"

// ---- steps --------------------------------------------------------------------------------------

// Ticks, sequences and hashes are stored as signed 64-bit integers with the same bits. Times are
// Unix milliseconds. `session` is sessions.key, not the id, so that an id is free again when its
// session is deleted.
static const char first_step[] =
	"CREATE TABLE meta(name TEXT PRIMARY KEY, value) WITHOUT ROWID;"

	// deleted: 1: the rows of this session are being removed in small steps; 2: so are its answers,
    // since another daemon has them.
	"CREATE TABLE sessions(key INTEGER PRIMARY KEY, id TEXT NOT NULL, name TEXT NOT NULL,"
	" state TEXT NOT NULL, branch INTEGER NOT NULL, created_ms INTEGER NOT NULL,"
	" deleted INTEGER NOT NULL DEFAULT 0, definition BLOB NOT NULL, mesh BLOB NOT NULL);"
	"CREATE UNIQUE INDEX session_by_id ON sessions(id) WHERE deleted = 0;"

	// bytes: size of the commands and checkpoints on this branch. end_tick: retention has removed
    // the commands from that tick on.
	"CREATE TABLE branches(session INTEGER NOT NULL, branch INTEGER NOT NULL,"
	" parent INTEGER NOT NULL, fork_tick INTEGER NOT NULL, opened_ms INTEGER NOT NULL,"
	" left_ms INTEGER NOT NULL DEFAULT 0, bytes INTEGER NOT NULL DEFAULT 0,"
	" end_tick INTEGER NOT NULL DEFAULT 9223372036854775807,"
	" PRIMARY KEY(session, branch)) WITHOUT ROWID;"

	"CREATE TABLE commands(session INTEGER NOT NULL, branch INTEGER NOT NULL, tick INTEGER NOT "
	"NULL,"
	" position INTEGER NOT NULL, kind INTEGER NOT NULL, client TEXT, sequence INTEGER,"
	" payload BLOB NOT NULL, PRIMARY KEY(session, branch, tick, position)) WITHOUT ROWID;"

	"CREATE TABLE checkpoints(session INTEGER NOT NULL, branch INTEGER NOT NULL,"
	" tick INTEGER NOT NULL, hash INTEGER NOT NULL, bytes INTEGER NOT NULL,"
	" snapshot BLOB NOT NULL, PRIMARY KEY(session, branch, tick));"

	// Events with session 0 are the daemon's own.
	"CREATE TABLE events(key INTEGER PRIMARY KEY, session INTEGER NOT NULL, tick INTEGER NOT NULL,"
	" level INTEGER NOT NULL, time_ms INTEGER NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL);"
	"CREATE INDEX event_by_session ON events(session, key);"

	// An answer outlives its session: a resent request to destroy the session still gets its
    // answer.
	"CREATE TABLE answers(client TEXT NOT NULL, sequence INTEGER NOT NULL, time_ms INTEGER NOT "
	"NULL,"
	" session TEXT, result BLOB NOT NULL, PRIMARY KEY(client, sequence)) WITHOUT ROWID;"
	"CREATE INDEX answer_by_time ON answers(time_ms);";

// The clients that have driven a session. With this table, a read of the clients need not search
// the session's log.
static const char second_step[] =
	"CREATE TABLE clients(session INTEGER NOT NULL, client TEXT NOT NULL,"
	" sequence INTEGER NOT NULL, PRIMARY KEY(session, client)) WITHOUT ROWID;"
	"INSERT INTO clients SELECT session, client, max(sequence) FROM commands"
	" WHERE client IS NOT NULL GROUP BY session, client;";

// Events belong to branches. forgotten: for each client, the newest sequence whose answer has been
// removed by age. A request that is not newer and has no answer has already acted.
static const char third_step[] =
	"ALTER TABLE events ADD COLUMN branch INTEGER NOT NULL DEFAULT 0;"
	"CREATE TABLE forgotten(client TEXT PRIMARY KEY, sequence INTEGER NOT NULL,"
	" time_ms INTEGER NOT NULL) WITHOUT ROWID;"
	"CREATE INDEX forgotten_by_time ON forgotten(time_ms);";

// marks: states that retention keeps. In older stores, the first state and the named ones are known
// from their events. gaps: commands of a branch with from_tick <= tick < before_tick are missing,
// because retention removed them (trimmed) or because they could not be stored.
static const char fourth_step[] =
	"CREATE TABLE marks(session INTEGER NOT NULL, branch INTEGER NOT NULL,"
	" tick INTEGER NOT NULL, PRIMARY KEY(session, branch, tick)) WITHOUT ROWID;"
	"INSERT OR IGNORE INTO marks SELECT session, branch, tick FROM events"
	" WHERE session > 0 AND kind IN ('created', 'snapshot');"
	"CREATE TABLE gaps(session INTEGER NOT NULL, branch INTEGER NOT NULL,"
	" from_tick INTEGER NOT NULL, before_tick INTEGER NOT NULL, trimmed INTEGER NOT NULL,"
	" PRIMARY KEY(session, branch, from_tick)) WITHOUT ROWID;";

// moved: sessions that another daemon has now. Such a row decides the move: the transaction that
// removes the session writes it, and its `proof` allows the other daemon to serve the session.
// arrivals: sessions on their way here, whose rows are stored under the same id. An arrival is
// served once it is accepted, by a proof whose SHA-256 is `lock`.
static const char fifth_step[] =
	"CREATE TABLE moved(id TEXT PRIMARY KEY, move TEXT NOT NULL, target TEXT NOT NULL,"
	" label TEXT NOT NULL, url TEXT NOT NULL, proof TEXT NOT NULL, time_ms INTEGER NOT NULL)"
	" WITHOUT ROWID;"
	"CREATE TABLE arrivals(id TEXT PRIMARY KEY, move TEXT NOT NULL, lock TEXT NOT NULL,"
	" source TEXT NOT NULL, label TEXT NOT NULL, pieces INTEGER NOT NULL, state INTEGER NOT NULL,"
	" time_ms INTEGER NOT NULL) WITHOUT ROWID;";

// Estimated bytes of one stored answer. Answers have a share of the budget, so triggers keep the
// sum of these bytes. An answer is in the table and in two indices; a long one has pages of its
// own.
#define ANSWER_BYTES(row)                                                                          \
	"length(" row "result) + 4096 * (length(" row "result) > 900) + 3 * length(" row               \
	"client) + 2 * coalesce(length(" row "session), 0)"                                            \
	" + 100"
static const char sixth_step[] =
	"CREATE INDEX answer_by_session ON answers(session);"
	"CREATE TABLE sizes(name TEXT PRIMARY KEY, bytes INTEGER NOT NULL) WITHOUT ROWID;"
	"INSERT INTO sizes SELECT 'answers', coalesce(sum(" ANSWER_BYTES(
		"") "), 0) FROM answers;"
			"CREATE TRIGGER answer_added AFTER INSERT ON answers BEGIN"
			" UPDATE sizes SET bytes = bytes + " ANSWER_BYTES(
				"new.") " WHERE name = 'answers'; END;"
						"CREATE TRIGGER answer_removed AFTER DELETE ON answers BEGIN"
						" UPDATE sizes SET bytes = bytes - (" ANSWER_BYTES(
							"old.") ") WHERE name = 'answers'; END;";

// secrets: random texts of this store. arrivals.unlock: hash of the release that allows to forget
// the move. arrivals.seal: seal of the pieces received so far (server/move/courier.h).
static const char seventh_step[] =
	"CREATE TABLE secrets(name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;"
	"INSERT INTO secrets VALUES('move', lower(hex(randomblob(32))));"
	"ALTER TABLE arrivals ADD COLUMN unlock TEXT NOT NULL DEFAULT '';"
	"ALTER TABLE arrivals ADD COLUMN seal TEXT NOT NULL DEFAULT '';";

const char *const cau_store_schema_steps[CAU_STORE_SCHEMA_VERSION] = {
	first_step, second_step, third_step, fourth_step, fifth_step, sixth_step, seventh_step};

// ---- migration ----------------------------------------------------------------------------------

static cau_status run_steps(sqlite3 *database, int64_t version, cau_error *error)
{
	char sql[96];
	for (int64_t step = version; step < CAU_STORE_SCHEMA_VERSION; step++) {
		cau_status status = cau_store_execute(database, cau_store_schema_steps[step],
		                                      "migrating the schema", error);
		if (status)
			return status;
	}
	snprintf(sql, sizeof sql, "PRAGMA application_id = %d; PRAGMA user_version = %d",
	         CAU_STORE_APPLICATION_ID, CAU_STORE_SCHEMA_VERSION);
	cau_status status = cau_store_execute(database, sql, "stating the schema version", error);
	if (status)
		return status;
	// Compile the statements before the commit, so that an unexpected file stays unchanged.
	struct cau_store_writer writer;
	status = cau_store_writer_init(&writer, database, error);
	if (!status)
		cau_store_writer_finish(&writer);
	return status;
}

cau_status cau_store_migrate(sqlite3 *database, cau_error *error)
{
	int64_t version;
	cau_status status = cau_store_integer(database, "PRAGMA user_version", &version, error);
	if (status || version == CAU_STORE_SCHEMA_VERSION)
		return status;
	status = cau_store_execute(database, "BEGIN IMMEDIATE", "migrating the schema", error);
	if (status)
		return status;
	status = run_steps(database, version, error);
	if (!status)
		status = cau_store_execute(database, "COMMIT", "migrating the schema", error);
	if (status && !sqlite3_get_autocommit(database))
		sqlite3_exec(database, "ROLLBACK", NULL, NULL, NULL);
	return status;
}

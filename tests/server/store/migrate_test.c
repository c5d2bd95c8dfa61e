// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that stores with older schemas are migrated with all their records. The old layouts are
// written here as they were: they must not follow later changes of the schema.
#include "store_fixture.h"

#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

#include "store/file.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

static void execute(const char *path, const char *sql)
{
	sqlite3 *database;
	assert_int_equal(sqlite3_open(path, &database), SQLITE_OK);
	if (sqlite3_exec(database, sql, NULL, NULL, NULL))
		fail_msg("%s", sqlite3_errmsg(database));
	assert_int_equal(sqlite3_close(database), SQLITE_OK);
}

static int64_t stored_version(const char *path)
{
	sqlite3 *database;
	int64_t version = -1;
	assert_int_equal(sqlite3_open(path, &database), SQLITE_OK);
	assert_int_equal(cau_store_integer(database, "PRAGMA user_version", &version, NULL), CAU_OK);
	sqlite3_close(database);
	return version;
}

// Version 0: our application id, but no tables yet.
static const char version_0[] = "PRAGMA journal_mode = WAL; PRAGMA application_id = 1130460532;";

// Version 1: without the table of clients.
static const char version_1[] =
	"PRAGMA journal_mode = WAL; PRAGMA application_id = 1130460532; PRAGMA user_version = 1;"
	"CREATE TABLE meta(name TEXT PRIMARY KEY, value) WITHOUT ROWID;"
	"CREATE TABLE sessions(key INTEGER PRIMARY KEY, id TEXT NOT NULL, name TEXT NOT NULL,"
	" state TEXT NOT NULL, branch INTEGER NOT NULL, created_ms INTEGER NOT NULL,"
	" deleted INTEGER NOT NULL DEFAULT 0, definition BLOB NOT NULL, mesh BLOB NOT NULL);"
	"CREATE UNIQUE INDEX session_by_id ON sessions(id) WHERE deleted = 0;"
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
	"CREATE TABLE events(key INTEGER PRIMARY KEY, session INTEGER NOT NULL, tick INTEGER NOT NULL,"
	" level INTEGER NOT NULL, time_ms INTEGER NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL);"
	"CREATE INDEX event_by_session ON events(session, key);"
	"CREATE TABLE answers(client TEXT NOT NULL, sequence INTEGER NOT NULL, time_ms INTEGER NOT "
	"NULL,"
	" session TEXT, result BLOB NOT NULL, PRIMARY KEY(client, sequence)) WITHOUT ROWID;"
	"CREATE INDEX answer_by_time ON answers(time_ms);";

static const char version_1_rows[] =
	"INSERT INTO meta VALUES('label', 'd7');"
	"INSERT INTO sessions VALUES(1, 'd7-knee', 'a knee', 'paused', 0, 1234, 0, x'7b7d', x'');"
	"INSERT INTO branches(session, branch, parent, fork_tick, opened_ms) VALUES(1, 0, -1, 0, 1234);"
	"INSERT INTO commands VALUES(1, 0, 5, 0, 3, NULL, NULL, x'0500000000000000');"
	"INSERT INTO commands VALUES(1, 0, 6, 0, 3, 'browser', 11, x'0600000000000000');"
	"INSERT INTO commands VALUES(1, 0, 9, 0, 3, 'browser', 14, x'0900000000000000');"
	"INSERT INTO commands VALUES(1, 0, 9, 1, 3, 'robot', 2, x'0900000000000000');"
	"INSERT INTO checkpoints VALUES(1, 0, 5, -2, 67, x'abcdef');"
	"INSERT INTO answers VALUES('browser', 11, 1700000000000, 'd7-knee', x'6f6b');";

static void an_empty_store_of_version_0_is_migrated(void **state)
{
	struct fixture *fixture = *state;
	execute(fixture->path, version_0);
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	cau_store_close(store);
	assert_int_equal(stored_version(fixture->path), CAU_STORE_SCHEMA_VERSION);
}

static cau_status see_client(void *user, const char *client, uint64_t sequence)
{
	char *text = user;
	sprintf(text + strlen(text), "%s:%d ", client, (int)sequence);
	return CAU_OK;
}

static cau_status see_answer(void *user, const cau_store_answer *answer)
{
	assert_memory_equal(answer->result.data, "ok", 2);
	*(bool *)user = true;
	return CAU_OK;
}

static cau_status see_checkpoint(void *user, const cau_store_checkpoint *checkpoint)
{
	assert_true(checkpoint->hash == UINT64_MAX - 1);
	assert_memory_equal(checkpoint->snapshot.data, "\xab\xcd\xef", 3);
	*(bool *)user = true;
	return CAU_OK;
}

static void version_1_is_migrated_with_all_it_holds(void **state)
{
	struct fixture *fixture = *state;
	uint64_t ticks[8];
	char clients[64] = "";
	bool answered = false, restored = false;
	execute(fixture->path, version_1);
	execute(fixture->path, version_1_rows);
	fixture->config.wall_clock_ms = NULL;
	cau_store *store = open_store(&fixture->config);
	assert_string_equal(cau_store_label(store), "d7");
	assert_int_equal(read_ticks(store, "d7-knee", 0, 0, 100, ticks, 8), 4);
	assert_int_equal(cau_store_read_answer(store, "browser", 11, see_answer, &answered, NULL),
	                 CAU_OK);
	assert_int_equal(
		cau_store_read_checkpoint(store, "d7-knee", 0, 100, see_checkpoint, &restored, NULL),
		CAU_OK);
	assert_true(answered && restored);
	assert_int_equal(cau_store_read_clients(store, "d7-knee", see_client, clients, NULL), CAU_OK);
	assert_string_equal(clients, "browser:14 robot:2 "); // the migration found them in the log
	cau_store_close(store);
	assert_int_equal(stored_version(fixture->path), CAU_STORE_SCHEMA_VERSION);
}

static void a_migration_that_fails_changes_nothing(void **state)
{
	struct fixture *fixture = *state;
	cau_store *store = NULL;
	cau_error error = {0};
	size_t before_bytes, after_bytes;
	execute(fixture->path, version_1);
	execute(fixture->path, version_1_rows);
	execute(fixture->path, "CREATE TABLE clients(surprise)");
	unsigned char *before = read_file(fixture->path, &before_bytes);
	assert_int_equal(cau_store_open(&fixture->config, &store, &error), CAU_CORRUPT);
	assert_non_null(strstr(error.reason, "clients"));
	unsigned char *after = read_file(fixture->path, &after_bytes);
	assert_int_equal(before_bytes, after_bytes);
	assert_memory_equal(before, after, before_bytes);
	free(before);
	free(after);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(an_empty_store_of_version_0_is_migrated),
		TEST(version_1_is_migrated_with_all_it_holds),
		TEST(a_migration_that_fails_changes_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that files that are not a sound store of a known schema are refused with the reason.
// Neither the files nor their folder change.
#include "store_fixture.h"

#include <dirent.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

// Every file of a folder with its bytes, as one block to compare.
struct picture {
	size_t bytes;
	char *data;
};

static int is_no_dot(const struct dirent *entry)
{
	return entry->d_name[0] != '.';
}

static struct picture take_picture(const char *folder)
{
	struct dirent **entries;
	struct picture picture = {0};
	FILE *stream = open_memstream(&picture.data, &picture.bytes);
	int count = scandir(folder, &entries, is_no_dot, alphasort);
	assert_true(count >= 0);
	for (int i = 0; i < count; i++) {
		char path[512];
		struct stat file;
		snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
		assert_int_equal(stat(path, &file), 0);
		fprintf(stream, "%s %o %lld.%09ld\n", entries[i]->d_name, file.st_mode,
		        (long long)file.st_mtim.tv_sec, file.st_mtim.tv_nsec);
		if (S_ISREG(file.st_mode)) {
			size_t bytes;
			unsigned char *data = read_file(path, &bytes);
			fwrite(data, 1, bytes, stream);
			free(data);
		}
		free(entries[i]);
	}
	free(entries);
	fclose(stream);
	return picture;
}

// Opens the store. Expects the refusal, a reason with `phrase`, and an unchanged folder.
static void expect_refusal(const struct fixture *fixture, cau_status expected, const char *phrase)
{
	cau_store *store = NULL;
	cau_error error = {0};
	struct picture before = take_picture(fixture->folder);
	assert_int_equal(cau_store_open(&fixture->config, &store, &error), expected);
	assert_null(store);
	struct picture after = take_picture(fixture->folder);
	if (!strstr(error.reason, phrase))
		fail_msg("'%s' does not say '%s'", error.reason, phrase);
	assert_string_equal(error.file, fixture->config.path);
	assert_int_equal(before.bytes, after.bytes);
	assert_memory_equal(before.data, after.data, before.bytes);
	free(before.data);
	free(after.data);
}

static void execute(const char *path, const char *sql)
{
	sqlite3 *database;
	assert_int_equal(sqlite3_open(path, &database), SQLITE_OK);
	assert_int_equal(sqlite3_exec(database, sql, NULL, NULL, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_close(database), SQLITE_OK);
}

// Makes a closed store with a session and a hundred kilobytes of log.
static void make_store(const struct fixture *fixture)
{
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	cau_store_batch *batch = cau_store_batch_create();
	for (uint64_t tick = 0; tick < 2000; tick++)
		put_tick_command(batch, "knee", 0, tick);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	cau_store_close(store);
}

static void something_else_is_refused(void **state)
{
	struct fixture *fixture = *state;
	static const char text[] =
		"Dear diary, this is not a database, and it is longer than the header "
		"that a database has, so that its length cannot tell.\n";
	write_file(fixture->path, text, sizeof text);
	expect_refusal(fixture, CAU_CORRUPT, "not a database");
	write_file(fixture->path, text, 20);
	expect_refusal(fixture, CAU_CORRUPT, "not a database");
	write_file(fixture->path, text, 0);
	expect_refusal(fixture, CAU_CORRUPT, "empty");
	assert_int_equal(unlink(fixture->path), 0);
	assert_int_equal(mkdir(fixture->path, 0700), 0);
	expect_refusal(fixture, CAU_UNSUPPORTED, "regular file");
}

static void another_programs_database_is_refused(void **state)
{
	struct fixture *fixture = *state;
	execute(fixture->path, "CREATE TABLE songs(title); INSERT INTO songs VALUES('x')");
	expect_refusal(fixture, CAU_UNSUPPORTED, "another program");
	execute(fixture->path, "PRAGMA journal_mode = WAL; PRAGMA application_id = 77");
	expect_refusal(fixture, CAU_UNSUPPORTED, "0x4d");
}

static void a_newer_schema_is_refused(void **state)
{
	struct fixture *fixture = *state;
	make_store(fixture);
	execute(fixture->path, "PRAGMA user_version = 99");
	expect_refusal(fixture, CAU_UNSUPPORTED, "schema 99");
}

// Copies a store's files while it is open, which gives the files that a crash leaves.
static void copy_crashed(const struct fixture *fixture, const char *path)
{
	static const char *const suffixes[] = {"", "-wal"};
	for (size_t i = 0; i < 2; i++) {
		char from[256], to[256];
		size_t bytes;
		snprintf(from, sizeof from, "%s%s", fixture->path, suffixes[i]);
		snprintf(to, sizeof to, "%s%s", path, suffixes[i]);
		unsigned char *data = read_file(from, &bytes);
		assert_true(bytes > 0);
		write_file(to, data, bytes);
		free(data);
	}
}

// Makes a crashed store: runs `sql` beside an open store, so that its effect is only in the log,
// and copies the files into a new fixture.
static void crash_with(struct fixture *fixture, struct fixture *crashed, const char *sql)
{
	void *made;
	assert_int_equal(fixture_setup(&made), 0);
	*crashed = *(struct fixture *)made;
	free(made);
	make_store(fixture);
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, command_batch("knee", 0, 5000), NULL), CAU_OK);
	execute(fixture->path, sql);
	copy_crashed(fixture, crashed->path);
	cau_store_close(store);
	crashed->config.path = crashed->path;
}

static void a_newer_schema_in_the_log_is_refused(void **state)
{
	struct fixture *fixture = *state, crashed;
	crash_with(fixture, &crashed, "PRAGMA user_version = 99");
	expect_refusal(&crashed, CAU_UNSUPPORTED, "schema 99");
	remove_tree(crashed.folder);
}

static void a_crashed_store_opens_with_its_log(void **state)
{
	struct fixture *fixture = *state, crashed;
	uint64_t ticks[2];
	crash_with(fixture, &crashed, "SELECT 1");
	cau_store *store = open_store(&crashed.config);
	assert_int_equal(read_ticks(store, "knee", 0, 4000, 6000, ticks, 2), 1);
	cau_store_close(store);
	remove_tree(crashed.folder);
}

static void overwrite(const char *path, long at, size_t bytes)
{
	static const unsigned char garbage[65536] = {0xba, 0xad, 0xf0, 0x0d};
	FILE *file = fopen(path, "r+b");
	assert_non_null(file);
	fseek(file, at, SEEK_SET);
	assert_int_equal(fwrite(garbage, 1, bytes, file), bytes);
	fclose(file);
}

static void a_damaged_store_is_refused(void **state)
{
	struct fixture *fixture = *state;
	make_store(fixture);
	overwrite(fixture->path, 4 * 4096, 65536);
	expect_refusal(fixture, CAU_CORRUPT, "");
}

static void a_damaged_store_with_a_log_is_refused(void **state)
{
	struct fixture *fixture = *state, crashed;
	crash_with(fixture, &crashed, "SELECT 1");
	overwrite(crashed.path, 4 * 4096, 65536);
	expect_refusal(&crashed, CAU_CORRUPT, "");
	remove_tree(crashed.folder);
}

static void a_truncated_store_is_refused(void **state)
{
	struct fixture *fixture = *state;
	size_t bytes;
	make_store(fixture);
	unsigned char *data = read_file(fixture->path, &bytes);
	write_file(fixture->path, data, bytes / 2);
	expect_refusal(fixture, CAU_CORRUPT, "");
	write_file(fixture->path, data, 4096);
	expect_refusal(fixture, CAU_CORRUPT, "");
	write_file(fixture->path, data, 101);
	expect_refusal(fixture, CAU_CORRUPT, "");
	free(data);
}

static void a_store_without_a_table_is_refused(void **state)
{
	struct fixture *fixture = *state;
	make_store(fixture);
	execute(fixture->path, "DROP TABLE clients");
	expect_refusal(fixture, CAU_CORRUPT, "clients");
}

static void a_lone_log_and_a_journal_are_refused(void **state)
{
	struct fixture *fixture = *state;
	char beside[256];
	snprintf(beside, sizeof beside, "%s-wal", fixture->path);
	write_file(beside, "frames", 6);
	expect_refusal(fixture, CAU_CORRUPT, "missing");
	assert_int_equal(unlink(beside), 0);
	make_store(fixture);
	snprintf(beside, sizeof beside, "%s-journal", fixture->path);
	write_file(beside, "pages", 5);
	expect_refusal(fixture, CAU_CORRUPT, "journal");
}

static void the_label_is_kept_and_guarded(void **state)
{
	struct fixture *fixture = *state;
	fixture->config.label = "d1";
	make_store(fixture);
	fixture->config.label = "d2";
	expect_refusal(fixture, CAU_BAD_STATE, "'d1'");
	fixture->config.label = NULL;
	cau_store *store = open_store(&fixture->config);
	assert_string_equal(cau_store_label(store), "d1");
	cau_store_close(store);
}

static void a_new_store_takes_no_label_with_a_dash(void **state)
{
	struct fixture *fixture = *state;
	fixture->config.label = "or-1";
	expect_refusal(fixture, CAU_BAD_VALUE, "`or-1` has a `-`");
	// A store that already has a label with a dash still opens with it.
	fixture->config.label = "or1";
	make_store(fixture);
	execute(fixture->path, "UPDATE meta SET value = 'or-1' WHERE name = 'label'");
	fixture->config.label = "or-1";
	cau_store *store = open_store(&fixture->config);
	assert_string_equal(cau_store_label(store), "or-1");
	cau_store_close(store);
}

static void bad_configurations_are_refused(void **state)
{
	struct fixture *fixture = *state;
	cau_store *store;
	cau_error error;
	fixture->config.commit_delay_ms = 11;
	assert_int_equal(cau_store_open(&fixture->config, &store, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "commit_delay_ms");
	fixture->config.commit_delay_ms = 5;
	fixture->config.path = "/nowhere/at/all/store.db";
	assert_int_equal(cau_store_open(&fixture->config, &store, &error), CAU_IO);
	fixture->config.path = NULL;
	assert_int_equal(cau_store_open(&fixture->config, &store, &error), CAU_BAD_VALUE);
}

static void a_clean_close_leaves_one_file(void **state)
{
	struct fixture *fixture = *state;
	struct dirent **entries;
	make_store(fixture);
	assert_int_equal(scandir(fixture->folder, &entries, is_no_dot, alphasort), 1);
	assert_string_equal(entries[0]->d_name, "store.db");
	free(entries[0]);
	free(entries);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(something_else_is_refused),
		TEST(another_programs_database_is_refused),
		TEST(a_newer_schema_is_refused),
		TEST(a_newer_schema_in_the_log_is_refused),
		TEST(a_crashed_store_opens_with_its_log),
		TEST(a_damaged_store_is_refused),
		TEST(a_damaged_store_with_a_log_is_refused),
		TEST(a_truncated_store_is_refused),
		TEST(a_store_without_a_table_is_refused),
		TEST(a_lone_log_and_a_journal_are_refused),
		TEST(the_label_is_kept_and_guarded),
		TEST(a_new_store_takes_no_label_with_a_dash),
		TEST(bad_configurations_are_refused),
		TEST(a_clean_close_leaves_one_file),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a store is open in one process only, and only once in that process.
#include "store_fixture.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

static void a_second_open_in_the_process_is_refused(void **state)
{
	struct fixture *fixture = *state;
	cau_store *second = NULL;
	cau_error error = {0};
	char pid[32];
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(cau_store_open(&fixture->config, &second, &error), CAU_BAD_STATE);
	snprintf(pid, sizeof pid, "process %ld", (long)getpid());
	assert_non_null(strstr(error.reason, pid));
	// The first store still has its locks.
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	cau_store_close(store);
	cau_store_close(open_store(&fixture->config));
}

static void another_name_of_the_file_is_the_same_store(void **state)
{
	struct fixture *fixture = *state;
	cau_store *second = NULL;
	char name[256];
	cau_store *store = open_store(&fixture->config);
	snprintf(name, sizeof name, "%s/alias.db", fixture->folder);
	assert_int_equal(symlink(fixture->path, name), 0);
	cau_store_config config = fixture->config;
	config.path = name;
	assert_int_equal(cau_store_open(&config, &second, NULL), CAU_BAD_STATE);
	cau_store_close(store);
}

static void a_hard_link_is_the_same_store(void **state)
{
	struct fixture *fixture = *state;
	cau_store *second = NULL;
	cau_error error = {0};
	char name[256];
	cau_store *store = open_store(&fixture->config);
	snprintf(name, sizeof name, "%s/link.db", fixture->folder);
	assert_int_equal(link(fixture->path, name), 0);
	cau_store_config config = fixture->config;
	config.path = name;
	assert_int_equal(cau_store_open(&config, &second, &error), CAU_BAD_STATE);
	assert_non_null(strstr(error.reason, "another name"));
	// The first store still has SQLite's locks.
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	cau_store_close(store);
	// After an orderly close the file is complete and has no log, so any name of the file can be
	// used.
	store = open_store(&config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_ALREADY_EXISTS);
	assert_int_equal(cau_store_open(&fixture->config, &second, NULL), CAU_BAD_STATE);
	cau_store_close(store);
	cau_store_close(open_store(&fixture->config));
}

// Opens the store, reports this with one byte, and waits to be killed.
static _Noreturn void hold_store(const cau_store_config *config, int ready)
{
	cau_store *store;
	if (cau_store_open(config, &store, NULL) == CAU_OK && write(ready, "!", 1) == 1)
		pause();
	_exit(1);
}

static void another_process_is_refused_until_the_holder_dies(void **state)
{
	struct fixture *fixture = *state;
	cau_store *store = NULL;
	cau_error error = {0};
	char byte, pid[32];
	int ready[2];
	assert_int_equal(pipe(ready), 0);
	pid_t child = fork();
	assert_true(child >= 0);
	if (child == 0)
		hold_store(&fixture->config, ready[1]);
	close(ready[1]);
	assert_int_equal(read(ready[0], &byte, 1), 1);
	assert_int_equal(cau_store_open(&fixture->config, &store, &error), CAU_BAD_STATE);
	snprintf(pid, sizeof pid, "process %ld", (long)child);
	assert_non_null(strstr(error.reason, pid));
	assert_int_equal(kill(child, SIGKILL), 0);
	assert_int_equal(waitpid(child, NULL, 0), child);
	cau_store_close(open_store(&fixture->config));
	close(ready[0]);
}

// Writes a session, reports this with one byte, and waits to be killed.
static _Noreturn void write_and_hold(const cau_store_config *config, int ready)
{
	cau_store *store;
	if (cau_store_open(config, &store, NULL) == CAU_OK &&
	    write_batch(store, session_batch("knee"), NULL) == CAU_OK && write(ready, "!", 1) == 1)
		pause();
	_exit(1);
}

// The killed process's last commits are in the log beside its name of the file. If the store were
// opened by the link, they would be lost; and opened by the first name later, the log would damage
// the file.
static void
a_hard_link_is_refused_while_another_process_lives_and_while_its_log_is_needed(void **state)
{
	struct fixture *fixture = *state;
	cau_store *store = NULL;
	cau_error error = {0};
	char byte, name[256];
	int ready[2];
	snprintf(name, sizeof name, "%s/link.db", fixture->folder);
	cau_store_config config = fixture->config;
	config.path = name;
	cau_store_close(open_store(&fixture->config));
	assert_int_equal(link(fixture->path, name), 0);
	assert_int_equal(pipe(ready), 0);
	pid_t child = fork();
	assert_true(child >= 0);
	if (child == 0)
		write_and_hold(&fixture->config, ready[1]);
	close(ready[1]);
	assert_int_equal(read(ready[0], &byte, 1), 1);
	assert_int_equal(cau_store_open(&config, &store, &error), CAU_BAD_STATE);
	assert_non_null(strstr(error.reason, "another process"));

	assert_int_equal(kill(child, SIGKILL), 0);
	assert_int_equal(waitpid(child, NULL, 0), child);
	assert_int_equal(cau_store_open(&config, &store, &error), CAU_BAD_STATE);
	assert_non_null(strstr(error.reason, fixture->path));
	// by its own name, the store opens at once, with everything that was committed
	store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_ALREADY_EXISTS);
	cau_store_close(store);
	store = open_store(&config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_ALREADY_EXISTS);
	cau_store_close(store);
	close(ready[0]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_second_open_in_the_process_is_refused),
		TEST(another_name_of_the_file_is_the_same_store),
		TEST(a_hard_link_is_the_same_store),
		TEST(another_process_is_refused_until_the_holder_dies),
		TEST(a_hard_link_is_refused_while_another_process_lives_and_while_its_log_is_needed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a copy that is taken while commands arrive. The copy has a complete beginning of the log.
#include "store_fixture.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "store/store.h"

enum { COMMANDS = 400 };

typedef struct writing {
	cau_store *store;
	atomic_int stored; // number of acknowledged commands
} writing;

static void *write_on(void *user)
{
	writing *w = user;
	for (uint64_t tick = 0; tick < COMMANDS; tick++) {
		assert_int_equal(write_batch(w->store, command_batch("knee", 0, tick), NULL), CAU_OK);
		w->stored++;
	}
	return NULL;
}

static void it_holds_what_was_acknowledged_and_opens(void **state)
{
	struct fixture *fixture = *state;
	char file[200];
	pthread_t thread;
	static uint64_t ticks[COMMANDS];
	writing w = {.store = open_store(&fixture->config)};
	assert_int_equal(write_batch(w.store, session_batch("knee"), NULL), CAU_OK);
	assert_int_equal(pthread_create(&thread, NULL, write_on, &w), 0);
	while (w.stored < COMMANDS / 4)
		usleep(1000);
	int before = w.stored;
	snprintf(file, sizeof file, "%s/copy.db", fixture->folder);
	assert_int_equal(cau_store_backup(fixture->path, file, NULL), CAU_OK);
	pthread_join(thread, NULL);
	assert_int_equal(read_ticks(w.store, "knee", 0, 0, COMMANDS, ticks, COMMANDS), COMMANDS);
	cau_store_close(w.store);
	cau_store_config restored = fixture->config;
	restored.path = file;
	cau_store *copy = open_store(&restored);
	int count = read_ticks(copy, "knee", 0, 0, COMMANDS, ticks, COMMANDS);
	assert_true(count >= before);
	for (int i = 0; i < count; i++)
		assert_int_equal(ticks[i], i);
	assert_int_equal(write_batch(copy, command_batch("knee", 0, COMMANDS), NULL), CAU_OK);
	cau_store_close(copy);
}

static void read_generation(const char *path, const struct fixture *fixture,
                            char text[CAU_STORE_ID_BYTES])
{
	cau_store_config config = fixture->config;
	config.path = path;
	cau_store *store = open_store(&config);
	assert_int_equal(cau_store_read_generation(store, text, NULL), CAU_OK);
	cau_store_close(store);
}

static void the_generation_stays_with_the_store(void **state)
{
	struct fixture *fixture = *state;
	char file[200], text[CAU_STORE_ID_BYTES];
	static const char *const words[] = {"1:a", "2:b"};
	read_generation(fixture->path, fixture, text);
	assert_string_equal(text, "");
	cau_store *store = open_store(&fixture->config);
	for (int i = 0; i < 2; i++) {
		cau_store_batch *batch = cau_store_batch_create();
		assert_int_equal(cau_store_put_generation(batch, "", NULL), CAU_BAD_VALUE);
		assert_int_equal(cau_store_put_generation(batch, words[i], NULL), CAU_OK);
		assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	}
	snprintf(file, sizeof file, "%s/copy.db", fixture->folder);
	assert_int_equal(cau_store_backup(fixture->path, file, NULL), CAU_OK);
	cau_store_close(store);
	read_generation(fixture->path, fixture, text);
	assert_string_equal(text, "2:b");
	read_generation(file, fixture, text);
	assert_string_equal(text, "");
}

static void nothing_is_replaced(void **state)
{
	struct fixture *fixture = *state;
	char file[200];
	size_t bytes;
	cau_store *store = open_store(&fixture->config);
	snprintf(file, sizeof file, "%s/copy.db", fixture->folder);
	write_file(file, "mine", 4);
	assert_int_equal(cau_store_backup(fixture->path, file, NULL), CAU_ALREADY_EXISTS);
	assert_int_equal(cau_store_backup(fixture->path, fixture->path, NULL), CAU_ALREADY_EXISTS);
	unsigned char *kept = read_file(file, &bytes);
	assert_int_equal(bytes, 4);
	free(kept);
	cau_store_close(store);
}

static void what_is_no_store_has_no_copy(void **state)
{
	struct fixture *fixture = *state;
	char file[200], other[200];
	snprintf(file, sizeof file, "%s/copy.db", fixture->folder);
	snprintf(other, sizeof other, "%s/other.db", fixture->folder);
	assert_int_equal(cau_store_backup(fixture->path, file, NULL), CAU_NOT_FOUND);
	write_file(other, "no database, and long enough to be looked at", 44);
	assert_int_not_equal(cau_store_backup(other, file, NULL), CAU_OK);
	assert_int_not_equal(access(file, F_OK), 0);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(it_holds_what_was_acknowledged_and_opens),
		TEST(the_generation_stays_with_the_store),
		TEST(nothing_is_replaced),
		TEST(what_is_no_store_has_no_copy),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Copies of a store that is in use: each is complete, only one is made at a time, and each request
// is answered exactly once.
#include "backup/backup.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "log/log.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, open_store, close_store)

enum {
	THREADS = 2
}; // a builder with one thread for any job has this one and the one for short jobs

static struct {
	char folder[40], file[64], copies[64], copy[80];
	cau_config config;
	cau_backups backups;
	pthread_mutex_t lock;
	pthread_cond_t news;
	int holding, answers; // holding: jobs that occupy a builder thread; answers: received answers
	bool holds;
	cau_status status;
} t;

static int open_store(void **state)
{
	(void)state;
	memset(&t, 0, sizeof t);
	pthread_mutex_init(&t.lock, NULL);
	pthread_cond_init(&t.news, NULL);
	cau_log_set_level("error");
	cau_config_default(&t.config);
	snprintf(t.folder, sizeof t.folder, "/tmp/cautery-backup-XXXXXX");
	if (!mkdtemp(t.folder))
		return -1;
	snprintf(t.file, sizeof t.file, "%s/store.db", t.folder);
	snprintf(t.copies, sizeof t.copies, "%s/backups", t.folder);
	snprintf(t.copy, sizeof t.copy, "%s/monday.db", t.copies);
	snprintf(t.config.store, sizeof t.config.store, "%s", t.file);
	t.backups.config = &t.config;
	cau_store_config of_store = cau_store_default_config();
	of_store.path = t.file;
	return cau_store_open(&of_store, &t.backups.store, NULL) ||
	               cau_builder_create(&t.backups.builder, "cautery-build", 1, 0, NULL)
	           ? -1
	           : 0;
}

static int close_store(void **state)
{
	(void)state;
	cau_builder_stop(t.backups.builder);
	cau_builder_destroy(t.backups.builder);
	cau_store_close(t.backups.store);
	unlink(t.copy);
	rmdir(t.copies);
	unlink(t.file);
	pthread_cond_destroy(&t.news);
	pthread_mutex_destroy(&t.lock);
	return rmdir(t.folder);
}

static void note_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	(void)user, (void)reply;
	pthread_mutex_lock(&t.lock);
	t.answers++;
	t.status = outcome->error ? outcome->error->status : CAU_OK;
	pthread_cond_broadcast(&t.news);
	pthread_mutex_unlock(&t.lock);
}

static cau_status make(void)
{
	cau_reply reply = {.answer = note_answer, .method = CAU_METHOD_STORE_BACKUP};
	return cau_backups_make(&t.backups, "monday", &reply, NULL);
}

static void await(const int *count, int wanted)
{
	pthread_mutex_lock(&t.lock);
	while (*count < wanted)
		pthread_cond_wait(&t.news, &t.lock);
	pthread_mutex_unlock(&t.lock);
}

// ---- a busy builder
static void hold(cau_job *job)
{
	(void)job;
	pthread_mutex_lock(&t.lock);
	t.holding++;
	pthread_cond_broadcast(&t.news);
	while (t.holds)
		pthread_cond_wait(&t.news, &t.lock);
	pthread_mutex_unlock(&t.lock);
}

static void let_go(void)
{
	pthread_mutex_lock(&t.lock);
	t.holds = false;
	pthread_cond_broadcast(&t.news);
	pthread_mutex_unlock(&t.lock);
}

// ---- the tests
static void note_stored(void *user, cau_status status, const char *reason)
{
	(void)reason;
	*(cau_status *)user = status;
}

static void store_session(const char *id)
{
	cau_status stored = CAU_STATUS_COUNT;
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_session row = {.id = id, .name = "knee", .state = "paused", .definition = {"{}", 2}};
	assert_int_equal(cau_store_put_session(batch, &row, NULL), CAU_OK);
	assert_int_equal(cau_store_submit(t.backups.store, batch, note_stored, &stored, NULL), CAU_OK);
	cau_store_flush(t.backups.store);
	assert_int_equal(stored, CAU_OK);
}

static cau_status count_session(void *user, const cau_store_session *session)
{
	*(int *)user += strcmp(session->id, "d1-knee") == 0;
	return CAU_OK;
}

static void a_copy_holds_what_was_committed(void **state)
{
	(void)state;
	int sessions = 0;
	cau_store *copy;
	cau_store_config of_copy = cau_store_default_config();
	store_session("d1-knee");
	assert_int_equal(make(), CAU_OK);
	await(&t.answers, 1);
	assert_int_equal(t.status, CAU_OK);
	of_copy.path = t.copy;
	assert_int_equal(cau_store_open(&of_copy, &copy, NULL), CAU_OK);
	assert_int_equal(cau_store_read_sessions(copy, count_session, &sessions, NULL), CAU_OK);
	assert_int_equal(sessions, 1);
	cau_store_close(copy);
}

static void one_copy_is_made_at_a_time(void **state)
{
	(void)state;
	cau_job jobs[THREADS];
	t.holds = true;
	for (int i = 0; i < THREADS; i++) {
		jobs[i] = (cau_job){.run = hold, .drop = hold};
		cau_builder_submit(t.backups.builder, &jobs[i]);
	}
	await(&t.holding, THREADS);
	assert_int_equal(make(), CAU_OK);
	assert_int_equal(make(), CAU_BAD_STATE);
	let_go();
	await(&t.answers, 1);
	assert_int_equal(t.status, CAU_OK);
	assert_int_equal(make(), CAU_OK);
	await(&t.answers, 2);
	assert_int_equal(t.status, CAU_ALREADY_EXISTS); // a copy replaces no existing file
}

static void a_copy_that_cannot_be_made_is_answered(void **state)
{
	(void)state;
	snprintf(t.config.backups, sizeof t.config.backups, "%s/nowhere", t.folder);
	assert_int_equal(make(), CAU_OK);
	await(&t.answers, 1);
	assert_int_equal(t.status, CAU_IO);
	cau_builder_stop(t.backups.builder);
	// the first dropped copy does not hinder the second
	for (int dropped = 1; dropped <= 2; dropped++) {
		assert_int_equal(make(), CAU_OK);
		assert_int_equal(t.answers, 1 + dropped);
		assert_int_equal(t.status, CAU_BAD_STATE);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_copy_holds_what_was_committed),
		TEST(one_copy_is_made_at_a_time),
		TEST(a_copy_that_cannot_be_made_is_answered),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

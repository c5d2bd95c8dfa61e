// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the sessions that a daemon starts with. The hub reports how many are not there yet, and the
// daemon takes no new sessions until then. Sessions of clients do not count.
#include "hub/hub.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "log/log.h"
#include "server/double/fake_session.h"
#include "server/hub/small_creation.h"

static struct {
	char folder[40], file[64];
	cau_config config;
	cau_store *store;
	cau_scenes *scenes;
	cau_worker_pool *pool;
	cau_builder *builder;
	cau_hub *hub;
	pthread_mutex_t lock;
	pthread_cond_t news;
	bool holds;   // threads that build wait
	int building; // number of threads that build
	int made;     // number of sessions whose creator was answered
} t;

static void armed(void *user)
{
	(void)user;
}

// Hook of the double: a thread that builds a core waits here while `holds` is set.
static void stand(cau_build_stage next)
{
	(void)next;
	pthread_mutex_lock(&t.lock);
	t.building++;
	pthread_cond_broadcast(&t.news);
	while (t.holds)
		pthread_cond_wait(&t.news, &t.lock);
	t.building--;
	pthread_mutex_unlock(&t.lock);
}

static void hold(bool holds)
{
	pthread_mutex_lock(&t.lock);
	t.holds = holds;
	pthread_cond_broadcast(&t.news);
	pthread_mutex_unlock(&t.lock);
}

static void await_building(void)
{
	pthread_mutex_lock(&t.lock);
	while (!t.building)
		pthread_cond_wait(&t.news, &t.lock);
	pthread_mutex_unlock(&t.lock);
}

static void see_made(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	(void)user;
	(void)reply;
	pthread_mutex_lock(&t.lock);
	t.made += !outcome->error;
	pthread_cond_broadcast(&t.news);
	pthread_mutex_unlock(&t.lock);
}

static void await_made(int count)
{
	pthread_mutex_lock(&t.lock);
	while (t.made < count)
		pthread_cond_wait(&t.news, &t.lock);
	pthread_mutex_unlock(&t.lock);
}

// ---- a daemon's life
static int start(void)
{
	cau_store_config of_store = cau_store_default_config();
	of_store.path = t.file;
	if (cau_store_open(&of_store, &t.store, NULL) ||
	    cau_scenes_load(&t.scenes, CAU_TEST_SCENES, NULL) ||
	    cau_worker_pool_create(&t.pool, 2, 4, 0, NULL) ||
	    cau_builder_create(&t.builder, "cautery-build", 1, 0, NULL))
		return -1;
	cau_hub_def def = {.config = &t.config,
	                   .store = t.store,
	                   .scenes = t.scenes,
	                   .pool = t.pool,
	                   .builder = t.builder,
	                   .armed = armed};
	return cau_hub_create(&t.hub, &def, NULL) ? -1 : 0;
}

static void stop(void)
{
	hold(false);
	cau_builder_stop(t.builder);
	cau_hub_stop(t.hub);
	cau_hub_destroy(t.hub);
	cau_builder_destroy(t.builder);
	cau_worker_pool_destroy(t.pool);
	cau_scenes_destroy(t.scenes);
	cau_store_close(t.store);
}

static int set_up(void **state)
{
	(void)state;
	memset(&t, 0, sizeof t);
	pthread_mutex_init(&t.lock, NULL);
	pthread_cond_init(&t.news, NULL);
	cau_fake_hooks_set.build = stand;
	cau_log_set_level("error");
	cau_config_default(&t.config);
	snprintf(t.folder, sizeof t.folder, "/tmp/cautery-resume-XXXXXX");
	if (!mkdtemp(t.folder))
		return -1;
	snprintf(t.file, sizeof t.file, "%s/store.db", t.folder);
	return start();
}

static int tear_down(void **state)
{
	(void)state;
	stop();
	cau_fake_hooks_set = (cau_fake_hooks){0};
	pthread_cond_destroy(&t.news);
	pthread_mutex_destroy(&t.lock);
	unlink(t.file);
	return rmdir(t.folder);
}

static void ask_for(const char *name)
{
	cau_reply reply = {.answer = see_made, .method = CAU_METHOD_SESSION_CREATE};
	cau_hub_submit_creation(t.hub, small_creation(name, reply));
}

// ---- tests
static void one_that_a_client_makes_does_not_count(void **state)
{
	(void)state;
	int32_t resumed;
	assert_int_equal(cau_hub_resume(t.hub, &resumed, NULL), CAU_OK);
	assert_int_equal(resumed, 0);
	hold(true);
	ask_for("knee");
	await_building();
	assert_int_equal(cau_hub_count(t.hub), 1);
	assert_int_equal(cau_hub_resuming(t.hub), 0);
	hold(false);
	await_made(1);
}

static void those_of_the_store_count_until_they_are_there(void **state)
{
	(void)state;
	int32_t resumed;
	ask_for("knee");
	ask_for("hip");
	await_made(2);
	stop();
	hold(true);
	assert_int_equal(start(), 0);
	assert_int_equal(cau_hub_resume(t.hub, &resumed, NULL), CAU_OK);
	assert_int_equal(resumed, 2);
	assert_int_equal(cau_hub_resuming(t.hub), 2);
	ask_for("elbow");
	hold(false);
	await_made(3);
	// The sessions start on the workers, after the builder. No notification reports this, so the
	// test polls.
	while (cau_hub_resuming(t.hub))
		usleep(1000);
	assert_int_equal(cau_hub_count(t.hub), 3);
}

static void the_demo_counts(void **state)
{
	(void)state;
	int32_t resumed;
	snprintf(t.config.demo, sizeof t.config.demo, "fascia");
	hold(true);
	assert_int_equal(cau_hub_resume(t.hub, &resumed, NULL), CAU_OK);
	await_building();
	assert_int_equal(cau_hub_resuming(t.hub), 1);
	ask_for("knee");
	hold(false);
	await_made(1); // waits for the client's session, which the clerk creates second
	while (cau_hub_resuming(t.hub))
		usleep(1000);
	assert_int_equal(cau_hub_count(t.hub), 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(one_that_a_client_makes_does_not_count, set_up, tear_down),
		cmocka_unit_test_setup_teardown(those_of_the_store_count_until_they_are_there, set_up,
	                                    tear_down),
		cmocka_unit_test_setup_teardown(the_demo_counts, set_up, tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/hosted_session/hosted_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "server/double/fake_session.h"

hosted_fixture t;

// ---- the surroundings ---------------------------------------------------------------------------

static void come_to(int here)
{
	if (!atomic_compare_exchange_strong(&t.held_at, &here, NOWHERE))
		return;
	pthread_barrier_wait(&t.met);
	pthread_barrier_wait(&t.over);
}

// Called when the store begins to write, because it asks for the time then.
static int64_t see_commit(void)
{
	if (atomic_exchange(&t.hold_commit, false)) {
		pthread_barrier_wait(&t.committing);
		pthread_barrier_wait(&t.commit);
	}
	return cau_wall_us() / 1000;
}

static void come_to_border(cau_build_stage next)
{
	come_to((int)next);
}

static cau_status come_to_restore(void)
{
	come_to(AT_RESTORE);
	return atomic_exchange(&t.fail_restore, false) ? CAU_NUMERICAL : CAU_OK;
}

static void see_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	(void)reply;
	hosted_answer *a = user;
	pthread_mutex_lock(&t.lock);
	a->count++;
	a->status = outcome->error ? outcome->error->status : CAU_OK;
	a->code = outcome->code;
	if (!outcome->error)
		snprintf(a->text, sizeof a->text, "%.*s", (int)outcome->text_bytes, outcome->text);
	else
		snprintf(a->reason, sizeof a->reason, "%.319s", outcome->error->reason);
	pthread_cond_broadcast(&t.answered);
	pthread_mutex_unlock(&t.lock);
}

static void notify(void *user, cau_audience audience, cau_buffer *text)
{
	(void)user, (void)audience;
	cau_buffer_release(text);
}

static void see_frames(void *user)
{
	(void)user;
}

static void see_slice(void *user, uint32_t session)
{
	(void)user, (void)session;
}

int hosted_open_surroundings(void **state)
{
	(void)state;
	memset(&t, 0, sizeof t);
	t.held_at = NOWHERE;
	pthread_mutex_init(&t.lock, NULL);
	pthread_cond_init(&t.answered, NULL);
	pthread_barrier_init(&t.met, NULL, 2);
	pthread_barrier_init(&t.over, NULL, 2);
	pthread_barrier_init(&t.committing, NULL, 2);
	pthread_barrier_init(&t.commit, NULL, 2);
	cau_log_set_level("error");
	cau_fake_hooks_set = (cau_fake_hooks){.build = come_to_border, .restore = come_to_restore};
	cau_config_default(&t.config);
	snprintf(t.folder, sizeof t.folder, "/tmp/cautery-building-XXXXXX");
	assert_non_null(mkdtemp(t.folder));
	snprintf(t.file, sizeof t.file, "%s/store.db", t.folder);
	cau_store_config of_store = cau_store_default_config();
	of_store.path = t.file;
	of_store.commit_delay_ms = 0;
	of_store.wall_clock_ms = see_commit;
	t.around = (cau_surroundings){.config = &t.config,
	                              .memory_held = &t.memory_held,
	                              .beginnings = &t.beginnings,
	                              .sink = {NULL, notify, see_frames, see_slice}};
	assert_int_equal(cau_store_open(&of_store, &t.around.store, NULL), CAU_OK);
	assert_int_equal(cau_worker_pool_create(&t.around.pool, 2, 4, 0, NULL), CAU_OK);
	assert_int_equal(cau_builder_create(&t.around.builder, "cautery-build", 1, 0, NULL), CAU_OK);
	cau_beginnings_init(&t.beginnings);
	return 0;
}

// Closes in the order of cau_hub_stop and the daemon. Fails if a session has not returned its
// memory.
int hosted_close_surroundings(void **state)
{
	(void)state;
	cau_builder_stop(t.around.builder);
	if (t.h)
		cau_hosted_stop(t.h);
	cau_store_flush(t.around.store);
	cau_hosted_release(t.h);
	cau_builder_destroy(t.around.builder);
	cau_beginnings_finish(&t.beginnings);
	cau_worker_pool_destroy(t.around.pool);
	cau_store_close(t.around.store);
	pthread_barrier_destroy(&t.met);
	pthread_barrier_destroy(&t.over);
	pthread_barrier_destroy(&t.committing);
	pthread_barrier_destroy(&t.commit);
	pthread_cond_destroy(&t.answered);
	pthread_mutex_destroy(&t.lock);
	unlink(t.file);
	rmdir(t.folder);
	return t.memory_held != 0;
}

cau_scene_def *hosted_make_scene(void)
{
	cau_scene_def *scene = calloc(1, sizeof *scene);
	cau_default_scene_def(scene);
	snprintf(scene->name, sizeof scene->name, "building");
	scene->layer_count = 1;
	cau_default_layer_def(&scene->layers[0], CAU_LAYER_FASCIA);
	snprintf(scene->layers[0].name, sizeof scene->layers[0].name, "sheet");
	scene->tool_count = 1;
	cau_default_tool_def(&scene->tools[0], CAU_TOOL_HOOK);
	snprintf(scene->tools[0].name, sizeof scene->tools[0].name, "hook");
	return scene;
}

cau_reply hosted_reply_to(int asked, cau_method method)
{
	return (cau_reply){.answer = see_answer, .user = &t.answers[asked], .method = method};
}

void hosted_begin(int held_at, int creation)
{
	t.held_at = held_at;
	cau_hosted_def def = {.id = "d1-building",
	                      .number = 1,
	                      .scene = hosted_make_scene(),
	                      .paused = true,
	                      .creator = {.client = CREATOR},
	                      .reply = hosted_reply_to(creation, CAU_METHOD_SESSION_CREATE)};
	assert_int_equal(cau_hosted_create(&t.h, &t.around, &def, NULL), CAU_OK);
	if (held_at != NOWHERE)
		pthread_barrier_wait(&t.met);
}

void hosted_go_on(void)
{
	pthread_barrier_wait(&t.over);
}

const hosted_answer *hosted_await(int asked)
{
	pthread_mutex_lock(&t.lock);
	while (!t.answers[asked].count)
		pthread_cond_wait(&t.answered, &t.lock);
	pthread_mutex_unlock(&t.lock);
	return &t.answers[asked];
}

cau_order *hosted_new_order(int asked, cau_order_kind kind, cau_method method)
{
	cau_order *order = calloc(1, sizeof *order);
	order->kind = kind;
	order->asker = (cau_asker){.client = 1, .role = CAU_ROLE_OPERATE, .client_id = "a-client"};
	order->reply = hosted_reply_to(asked, method);
	return order;
}

void hosted_submit(cau_order *order)
{
	cau_error error = {0};
	assert_int_equal(cau_hosted_submit(t.h, order, &error), CAU_OK);
}

void hosted_destroy(int asked, int64_t client_sequence)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_DESTROY, CAU_METHOD_SESSION_DESTROY);
	order->client_sequence = client_sequence;
	hosted_submit(order);
}

void hosted_turn_off_at_tick_1000(int asked)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_ENERGIZE);
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(order->as.command.tool, sizeof order->as.command.tool, "hook");
	order->as.command.tick = 1000;
	hosted_submit(order);
}

void hosted_let_go(void)
{
	cau_hosted_stop(t.h);
	cau_store_flush(t.around.store);
	cau_hosted_release(t.h);
	t.h = NULL;
}

static cau_status count_session(void *user, const cau_store_session *session)
{
	(void)session;
	++*(int *)user;
	return CAU_OK;
}

int hosted_stored_sessions(void)
{
	int count = 0;
	cau_store_flush(t.around.store);
	assert_int_equal(cau_store_read_sessions(t.around.store, count_session, &count, NULL), CAU_OK);
	return count;
}

static cau_status count_answer(void *user, const cau_store_answer *row)
{
	(void)row;
	++*(int *)user;
	return CAU_OK;
}

int hosted_stored_answers(uint64_t client_sequence)
{
	int count = 0;
	cau_error error = {0};
	cau_status status = cau_store_read_answer(t.around.store, "a-client", client_sequence,
	                                          count_answer, &count, &error);
	assert_true(status == CAU_OK || status == CAU_NOT_FOUND);
	return count;
}

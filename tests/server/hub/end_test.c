// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the end of the hub's sessions while transports still hold them.
#include "hub/hub.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "hosted_session/internal.h"
#include "log/log.h"
#include "server/hub/small_creation.h"

enum { CREATED, WAITING, TAKEN, ON, ANSWERS };

typedef struct answer {
	int count;
	cau_status status;
	int32_t code;
} answer;

static struct {
	char folder[40], file[64];
	cau_config config;
	cau_store *store;
	cau_worker_pool *pool;
	cau_builder *builder;
	cau_hub *hub;
	bool stopped;
	pthread_mutex_t lock;
	pthread_cond_t answered;
	answer answers[ANSWERS];
} t;

static void armed(void *user)
{
	(void)user;
}

static int open_hub(void **state)
{
	(void)state;
	memset(&t, 0, sizeof t);
	pthread_mutex_init(&t.lock, NULL);
	pthread_cond_init(&t.answered, NULL);
	cau_log_set_level("error");
	cau_config_default(&t.config);
	snprintf(t.folder, sizeof t.folder, "/tmp/cautery-end-XXXXXX");
	if (!mkdtemp(t.folder))
		return -1;
	snprintf(t.file, sizeof t.file, "%s/store.db", t.folder);
	cau_store_config of_store = cau_store_default_config();
	of_store.path = t.file;
	if (cau_store_open(&of_store, &t.store, NULL) ||
	    cau_worker_pool_create(&t.pool, 2, 4, 0, NULL) ||
	    cau_builder_create(&t.builder, "cautery-build", 1, 0, NULL))
		return -1;
	cau_hub_def def = {.config = &t.config,
	                   .store = t.store,
	                   .pool = t.pool,
	                   .builder = t.builder,
	                   .armed = armed};
	return cau_hub_create(&t.hub, &def, NULL) ? -1 : 0;
}

// Stops the builder and the hub, in the order of the daemon.
static void stop(void)
{
	if (t.stopped)
		return;
	t.stopped = true;
	cau_builder_stop(t.builder);
	cau_hub_stop(t.hub);
}

static int close_hub(void **state)
{
	(void)state;
	stop();
	cau_hub_destroy(t.hub);
	cau_builder_destroy(t.builder);
	cau_worker_pool_destroy(t.pool);
	cau_store_close(t.store);
	pthread_cond_destroy(&t.answered);
	pthread_mutex_destroy(&t.lock);
	unlink(t.file);
	return rmdir(t.folder);
}

static void see_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	(void)reply;
	answer *a = user;
	pthread_mutex_lock(&t.lock);
	a->count++;
	a->status = outcome->error ? outcome->error->status : CAU_OK;
	a->code = outcome->code;
	pthread_cond_broadcast(&t.answered);
	pthread_mutex_unlock(&t.lock);
}

static const answer *await(int asked)
{
	pthread_mutex_lock(&t.lock);
	while (!t.answers[asked].count)
		pthread_cond_wait(&t.answered, &t.lock);
	pthread_mutex_unlock(&t.lock);
	return &t.answers[asked];
}

static cau_reply reply_to(int asked, cau_method method)
{
	return (cau_reply){.answer = see_answer, .user = &t.answers[asked], .method = method};
}

static cau_hosted *make_session(void)
{
	cau_reply reply = reply_to(CREATED, CAU_METHOD_SESSION_CREATE);
	cau_hub_submit_creation(t.hub, small_creation("ending", reply));
	assert_int_equal(await(CREATED)->status, CAU_OK);
	cau_hosted *hosted = cau_hub_find_number(t.hub, 1);
	assert_non_null(hosted);
	return hosted;
}

// Returns an energy-off for a tick that does not come, so that the order waits.
static cau_order *order_for_later(void)
{
	cau_order *order = calloc(1, sizeof *order);
	order->kind = CAU_ORDER_COMMAND;
	order->asker = (cau_asker){.client = 1, .role = CAU_ROLE_OPERATE};
	order->reply = reply_to(WAITING, CAU_METHOD_TOOL_ENERGIZE);
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(order->as.command.tool, sizeof order->as.command.tool, "hook");
	order->as.command.tick = 1000;
	return order;
}

// The test holds a session as a transport's mailbox does. If the session is released after the
// hub's stop, no more answers are sent, because the transport may be partly destroyed.
static void a_session_that_is_held_outlives_the_hubs_stop(void **state)
{
	(void)state;
	cau_error error = {0};
	cau_hosted *held = make_session();
	assert_int_equal(cau_hosted_submit(held, order_for_later(), &error), CAU_OK);
	stop();
	assert_int_equal(t.answers[WAITING].count, 1);
	assert_int_equal(t.answers[WAITING].code, CAU_RPC_NOT_HERE);
	assert_int_equal(cau_hub_count(t.hub), 0);
	cau_order *late = order_for_later();
	assert_int_equal(cau_hosted_submit(held, late, &error), CAU_NOT_FOUND);
	free(late);
	cau_hosted_release(held);
	assert_int_equal(t.answers[WAITING].count, 1);
}

static cau_order *order_about_hook(int asked, cau_order_kind kind, cau_method method)
{
	cau_order *order = calloc(1, sizeof *order);
	order->kind = kind;
	order->asker = (cau_asker){.client = 1, .role = CAU_ROLE_OPERATE, .deadline_s = 1000};
	order->reply = reply_to(asked, method);
	return order;
}

// Energy must be off when the call returns, because the next steps of the daemon's end may wait:
// for DDS, for moves, for a slow disk.
static void as_time_stops_energy_goes_off_within_the_call(void **state)
{
	(void)state;
	cau_error error = {0};
	cau_hosted *held = make_session();
	cau_order *take = order_about_hook(TAKEN, CAU_ORDER_TAKE_OVER, CAU_METHOD_TOOL_TAKE_OVER);
	snprintf(take->as.tool.tool, sizeof take->as.tool.tool, "hook");
	assert_int_equal(cau_hosted_submit(held, take, &error), CAU_OK);
	assert_int_equal(await(TAKEN)->status, CAU_OK);
	cau_order *on = order_about_hook(ON, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_ENERGIZE);
	cau_default_command(&on->as.command, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(on->as.command.tool, sizeof on->as.command.tool, "hook");
	on->as.command.as.energized = true;
	assert_int_equal(cau_hosted_submit(held, on, &error), CAU_OK);
	assert_int_equal(await(ON)->status, CAU_OK);
	pthread_mutex_lock(&held->decisions.lock);
	assert_true(cau_logic_drive(held->decisions.logic, "hook")->enabled);
	pthread_mutex_unlock(&held->decisions.lock);
	cau_hub_stop_time(t.hub);
	pthread_mutex_lock(&held->decisions.lock);
	assert_false(cau_logic_drive(held->decisions.logic, "hook")->enabled);
	assert_true(held->decisions.logic->draining);
	pthread_mutex_unlock(&held->decisions.lock);
	cau_hosted_release(held);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_session_that_is_held_outlives_the_hubs_stop, open_hub,
	                                    close_hub),
		cmocka_unit_test_setup_teardown(as_time_stops_energy_goes_off_within_the_call, open_hub,
	                                    close_hub),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// A test in which the core heats a tool that no client has turned on, because the double ignores an
// energy-off. No tick is computed with this energy, and only this session is faulted.
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "server/double/fake_session.h"
#include "server/hosted_session/hosted_fixture.h"

enum { CREATED, TAKEN, ON, STEPPED, OFF, FAULTED, RESET, AGAIN };

static atomic_bool is_broken;

static bool breaks_off(void)
{
	return is_broken;
}

static const hosted_answer *ask(int asked, cau_order *order)
{
	order->asker.deadline_s = 1000;
	hosted_submit(order);
	return hosted_await(asked);
}

static const hosted_answer *step(int asked, int64_t ticks)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_STEP, CAU_METHOD_SESSION_STEP);
	order->as.ticks = ticks;
	return ask(asked, order);
}

static const hosted_answer *energize(int asked, bool on)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_ENERGIZE);
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(order->as.command.tool, sizeof order->as.command.tool, "hook");
	order->as.command.as.energized = on;
	return ask(asked, order);
}

static void turn_on_and_step(void)
{
	hosted_begin(NOWHERE, CREATED);
	assert_int_equal(hosted_await(CREATED)->status, CAU_OK);
	cau_order *order = hosted_new_order(TAKEN, CAU_ORDER_TAKE_OVER, CAU_METHOD_TOOL_TAKE_OVER);
	snprintf(order->as.tool.tool, sizeof order->as.tool.tool, "hook");
	assert_int_equal(ask(TAKEN, order)->status, CAU_OK);
	assert_int_equal(energize(ON, true)->status, CAU_OK);
	assert_int_equal(step(STEPPED, 3)->status, CAU_OK);
}

static void no_tick_begins_with_energy_that_nobody_turned_on(void **state)
{
	(void)state;
	turn_on_and_step();
	is_broken = true;
	assert_int_equal(energize(OFF, false)->status, CAU_OK);
	assert_int_not_equal(step(FAULTED, 5)->status, CAU_OK);
	assert_int_equal(cau_decisions_state(&t.h->decisions), CAU_SESSION_FAULTED);
	assert_int_equal(t.h->core.tick, 3);
	// a reset makes the session sound again
	is_broken = false;
	cau_order *order = hosted_new_order(RESET, CAU_ORDER_RESET, CAU_METHOD_SESSION_RESET);
	assert_int_equal(ask(RESET, order)->status, CAU_OK);
	assert_int_equal(cau_decisions_state(&t.h->decisions), CAU_SESSION_PAUSED);
	assert_int_equal(t.h->core.tick, 0);
}

// A broken safety rule ends no daemon. In every build it faults only this session, cuts off its
// tool's energy, and the requests are answered.
static void a_broken_rule_faults_the_session(void **state)
{
	(void)state;
	turn_on_and_step();
	pthread_mutex_lock(&t.h->decisions.lock);
	t.h->decisions.logic->steps_left = -7;
	pthread_mutex_unlock(&t.h->decisions.lock);
	cau_error error = {0};
	cau_order *finder = hosted_new_order(OFF, CAU_ORDER_PAUSE, CAU_METHOD_SESSION_PAUSE);
	cau_status found = cau_hosted_submit(t.h, finder, &error);
	// if nothing was found here, the worker found the broken rule first, in its last slice
	if (found) {
		assert_int_equal(found, CAU_FAULTED);
		assert_non_null(strstr(error.reason, "safety rule"));
		free(finder);
	} else {
		hosted_await(OFF);
	}
	const hosted_answer *answer = step(FAULTED, 5);
	assert_int_equal(answer->status, CAU_FAULTED);
	assert_non_null(strstr(answer->reason, "safety rule"));
	assert_int_equal(cau_decisions_state(&t.h->decisions), CAU_SESSION_FAULTED);
	assert_int_equal(t.h->core.tick, 3);
	cau_order *order = hosted_new_order(RESET, CAU_ORDER_RESET, CAU_METHOD_SESSION_RESET);
	assert_int_equal(ask(RESET, order)->status, CAU_OK);
	assert_int_equal(cau_decisions_state(&t.h->decisions), CAU_SESSION_PAUSED);
	// the worker's next act clears `rule_reported`, so that another broken rule is reported
	assert_int_equal(step(AGAIN, 1)->status, CAU_OK);
	pthread_mutex_lock(&t.h->decisions.lock);
	bool reported = t.h->decisions.rule_reported;
	pthread_mutex_unlock(&t.h->decisions.lock);
	assert_false(reported);
}

static void what_is_on_is_stepped(void **state)
{
	(void)state;
	turn_on_and_step();
	assert_int_equal(energize(OFF, false)->status, CAU_OK);
	assert_int_equal(step(FAULTED, 5)->status, CAU_OK);
	assert_int_equal(t.h->core.tick, 8);
}

static void nobody_watches(void *user)
{
	(void)user;
}

static int open_broken(void **state)
{
	is_broken = false;
	int failed = hosted_open_surroundings(state);
	cau_fake_hooks_set.breaks_off = breaks_off;
	t.around.armed = nobody_watches;
	return failed;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(no_tick_begins_with_energy_that_nobody_turned_on,
	                                    open_broken, hosted_close_surroundings),
		cmocka_unit_test_setup_teardown(a_broken_rule_faults_the_session, open_broken,
	                                    hosted_close_surroundings),
		cmocka_unit_test_setup_teardown(what_is_on_is_stepped, open_broken,
	                                    hosted_close_surroundings),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

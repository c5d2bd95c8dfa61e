// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a paused session whose store is full for a while. In the log of a tick, no entry follows a
// command that was lost. So a restart can replay each acknowledged command.
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "server/hosted_session/hosted_fixture.h"

enum { CREATED, TAKEN, BEFORE, LOST, BEHIND, ADVANCED, OFF, STEPPED, AFTER };

static void limit_files(rlim_t bytes)
{
	struct rlimit limit;
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
	limit.rlim_cur = bytes < limit.rlim_max ? bytes : limit.rlim_max;
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static const hosted_answer *set_gravity(int asked)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_COMMAND, CAU_METHOD_SET_GRAVITY);
	cau_default_command(&order->as.command, CAU_COMMAND_SET_GRAVITY);
	hosted_submit(order);
	return hosted_await(asked);
}

static const hosted_answer *turn_off(int asked)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_ENERGIZE);
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_ENERGIZE);
	strcpy(order->as.command.tool, "hook");
	hosted_submit(order);
	return hosted_await(asked);
}

static void take_hook(int asked)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_TAKE_OVER, CAU_METHOD_TOOL_TAKE_OVER);
	strcpy(order->as.tool.tool, "hook");
	hosted_submit(order);
	assert_int_equal(hosted_await(asked)->status, CAU_OK);
}

// Sends a request in lock-step with one command and no ticks.
static const hosted_answer *advance(int asked)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_ADVANCE, CAU_METHOD_SESSION_ADVANCE);
	size_t bytes = sizeof *order + sizeof(cau_advance) + sizeof(cau_command);
	order = realloc(order, bytes);
	cau_advance *made = (cau_advance *)(order + 1);
	cau_command *command = (cau_command *)(made + 1);
	cau_default_command(command, CAU_COMMAND_TOOL_MOVE);
	strcpy(command->tool, "hook");
	*made = (cau_advance){.command_count = 1, .commands = command};
	order->as.advance = made;
	hosted_submit(order);
	return hosted_await(asked);
}

static cau_status count_command(void *user, const cau_store_command *command)
{
	*(int *)user += command->kind == CAU_COMMAND_SET_GRAVITY;
	return CAU_OK;
}

static int logged(void)
{
	int count = 0;
	cau_store_flush(t.around.store);
	assert_int_equal(cau_store_read_log(t.around.store, t.h->identity.id, 0, 0, 1000, count_command,
	                                    &count, NULL),
	                 CAU_OK);
	return count;
}

static void await_store(cau_store_state state)
{
	cau_store_health health;
	do {
		usleep(1000);
		cau_store_get_health(t.around.store, &health);
	} while (health.state != state);
}

static void what_comes_behind_a_lost_command_is_not_acknowledged(void **state)
{
	(void)state;
	hosted_begin(NOWHERE, CREATED);
	assert_int_equal(hosted_await(CREATED)->status, CAU_OK);
	take_hook(TAKEN);
	assert_int_equal(set_gravity(BEFORE)->status, CAU_OK);
	limit_files(0);
	assert_int_equal(set_gravity(LOST)->code, CAU_RPC_STORE_FULL);
	limit_files(RLIM_INFINITY);
	await_store(CAU_STORE_READY);
	const hosted_answer *behind = set_gravity(BEHIND);
	assert_int_equal(behind->code, CAU_RPC_STORE_FULL);
	assert_non_null(strstr(behind->reason, "step or resume the session"));
	assert_int_equal(advance(ADVANCED)->code, CAU_RPC_STORE_FULL);
	assert_int_equal(turn_off(OFF)->status, CAU_OK);
	assert_non_null(strstr(t.answers[OFF].text, "\"stored\":false"));
	assert_int_equal(logged(), 1);
	cau_order *order = hosted_new_order(STEPPED, CAU_ORDER_STEP, CAU_METHOD_SESSION_STEP);
	order->as.ticks = 1;
	hosted_submit(order);
	assert_int_equal(hosted_await(STEPPED)->status, CAU_OK);
	assert_int_equal(set_gravity(AFTER)->status, CAU_OK);
	assert_int_equal(logged(), 2);
}

int main(void)
{
	signal(SIGXFSZ, SIG_IGN);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(what_comes_behind_a_lost_command_is_not_acknowledged,
	                                    hosted_open_surroundings, hosted_close_surroundings),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests past views of a session whose second core is stopped on its way. A client that cancels its
// view, disconnects, or loses the session gets the right answer. The session does not change.
#include <math.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "hosted_session/past_views.h"
#include "server/hosted_session/hosted_fixture.h"

enum { CREATED, STEPPED, FIRST, SECOND, THIRD, OTHER };
enum { TICKS = 20, ANYBODY = 1, SOMEBODY_ELSE = 2 };

static void begin(void)
{
	hosted_begin(NOWHERE, CREATED);
	assert_int_equal(hosted_await(CREATED)->status, CAU_OK);
	cau_order *order = hosted_new_order(STEPPED, CAU_ORDER_STEP, CAU_METHOD_SESSION_STEP);
	order->as.ticks = TICKS;
	hosted_submit(order);
	assert_int_equal(hosted_await(STEPPED)->status, CAU_OK);
}

static void look(int asked, uint32_t client, uint64_t tick)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_FRAME_AT, CAU_METHOD_SESSION_FRAME_AT);
	order->asker.client = client;
	order->as.frame_at.tick = tick;
	order->as.frame_at.step_m = 5e-5;
	order->as.frame_at.channels = CAU_CHANNEL_POSITIONS;
	hosted_submit(order);
}

// Stops the core on its way to the tick of the first view.
static void look_and_hold(void)
{
	begin();
	t.held_at = AT_RESTORE;
	look(FIRST, ANYBODY, 5);
	pthread_barrier_wait(&t.met);
}

// Waits until the session has served all earlier requests, by sending one more.
static void await_served(void)
{
	t.answers[OTHER].count = 0;
	hosted_submit(hosted_new_order(OTHER, CAU_ORDER_SNAPSHOTS, CAU_METHOD_SESSION_SNAPSHOTS));
	hosted_await(OTHER);
}

static void assert_shown(int asked, int tick)
{
	char member[32];
	snprintf(member, sizeof member, "\"tick\":%d,", tick);
	const hosted_answer *answered = hosted_await(asked);
	assert_int_equal(answered->status, CAU_OK);
	assert_non_null(strstr(answered->text, member));
}

static void assert_given_up(int asked, const char *when)
{
	const hosted_answer *answered = hosted_await(asked);
	assert_int_equal(answered->status, CAU_BAD_STATE);
	assert_non_null(strstr(answered->reason, when));
}

static void assert_where_it_was(void)
{
	cau_wire_session_summary summary;
	cau_hosted_summary(t.h, &summary);
	assert_int_equal(summary.tick, TICKS);
	assert_false(summary.has_stage);
}

static void each_look_is_answered_and_the_session_stays(void **state)
{
	(void)state;
	begin();
	look(FIRST, ANYBODY, 5);
	assert_shown(FIRST, 5);
	look(SECOND, ANYBODY, 12); // the replay continues from tick 5
	assert_shown(SECOND, 12);
	look(THIRD, ANYBODY, TICKS);
	assert_shown(THIRD, TICKS);
	assert_where_it_was();
}

static void who_asks_anew_gives_up_the_one_before(void **state)
{
	(void)state;
	look_and_hold();
	look(SECOND, ANYBODY, 6);
	look(THIRD, ANYBODY, 7);
	await_served();
	assert_given_up(SECOND, "before it began");
	hosted_go_on();
	assert_given_up(FIRST, "on the way");
	assert_shown(THIRD, 7);
	assert_where_it_was();
}

static void others_stand_in_line_and_give_up_nothing(void **state)
{
	(void)state;
	look_and_hold();
	look(SECOND, SOMEBODY_ELSE, 6);
	await_served();
	hosted_go_on();
	assert_shown(FIRST, 5);
	assert_shown(SECOND, 6);
}

static void a_look_can_be_cancelled(void **state)
{
	(void)state;
	look_and_hold();
	cau_order *order =
		hosted_new_order(SECOND, CAU_ORDER_FRAME_CANCEL, CAU_METHOD_SESSION_FRAME_CANCEL);
	hosted_submit(order);
	assert_int_equal(hosted_await(SECOND)->status, CAU_OK);
	hosted_go_on();
	assert_given_up(FIRST, "on the way");
}

static void who_is_gone_for_good_looks_at_nothing(void **state)
{
	(void)state;
	look_and_hold();
	look(SECOND, SOMEBODY_ELSE, 6);
	await_served();
	cau_hosted_forget_client(t.h, SOMEBODY_ELSE);
	assert_given_up(SECOND, "before it began");
	cau_hosted_forget_client(t.h, ANYBODY);
	hosted_go_on();
	assert_given_up(FIRST, "on the way");
}

static void where_the_way_fails_the_next_look_finds_another(void **state)
{
	(void)state;
	begin();
	t.fail_restore = true;
	look(FIRST, ANYBODY, 5);
	assert_int_equal(hosted_await(FIRST)->status, CAU_NUMERICAL);
	look(SECOND, ANYBODY, 6);
	assert_shown(SECOND, 6);
	assert_where_it_was();
}

static void beyond_the_present_is_nothing_to_see(void **state)
{
	(void)state;
	begin();
	look(FIRST, ANYBODY, TICKS + 1);
	assert_int_equal(hosted_await(FIRST)->status, CAU_BAD_VALUE);
}

static void destroyed_on_the_way_it_is_gone(void **state)
{
	(void)state;
	look_and_hold();
	look(SECOND, SOMEBODY_ELSE, 6);
	await_served();
	hosted_destroy(THIRD, 0);
	assert_int_equal(hosted_await(THIRD)->status, CAU_OK);
	hosted_go_on();
	assert_int_equal(hosted_await(FIRST)->code, CAU_RPC_NOT_HERE);
	assert_int_equal(hosted_await(SECOND)->code, CAU_RPC_NOT_HERE);
}

static void as_the_daemon_ends_looks_do(void **state)
{
	(void)state;
	look_and_hold();
	look(SECOND, SOMEBODY_ELSE, 6);
	await_served();
	cau_hosted_drain(t.h);
	hosted_go_on();
	assert_int_equal(hosted_await(FIRST)->code, CAU_RPC_DRAINING);
	assert_int_equal(hosted_await(SECOND)->code, CAU_RPC_DRAINING);
}

static void after_the_builder_stopped_nobody_looks(void **state)
{
	(void)state;
	begin();
	cau_builder_stop(t.around.builder);
	look(FIRST, ANYBODY, 5);
	assert_int_equal(hosted_await(FIRST)->code, CAU_RPC_DRAINING);
}

static void a_core_that_nobody_needs_goes(void **state)
{
	(void)state;
	begin();
	int64_t alone = t.memory_held;
	look(FIRST, ANYBODY, 5);
	assert_shown(FIRST, 5);
	assert_true(t.memory_held > alone);
	double due_s = INFINITY;
	while (due_s == INFINITY) { // the core is idle only after the answer
		sched_yield();
		due_s = cau_past_views_due_s(&t.h->past);
	}
	cau_past_views_tire(&t.h->past, due_s - 1);
	assert_true(t.memory_held > alone);
	cau_past_views_tire(&t.h->past, due_s);
	while (t.memory_held > alone)
		sched_yield();
	look(SECOND, ANYBODY, 6);
	assert_shown(SECOND, 6);
}

int main(void)
{
#define TEST(function)                                                                             \
	cmocka_unit_test_setup_teardown(function, hosted_open_surroundings, hosted_close_surroundings)
	const struct CMUnitTest tests[] = {
		TEST(each_look_is_answered_and_the_session_stays),
		TEST(who_asks_anew_gives_up_the_one_before),
		TEST(others_stand_in_line_and_give_up_nothing),
		TEST(a_look_can_be_cancelled),
		TEST(who_is_gone_for_good_looks_at_nothing),
		TEST(where_the_way_fails_the_next_look_finds_another),
		TEST(beyond_the_present_is_nothing_to_see),
		TEST(destroyed_on_the_way_it_is_gone),
		TEST(as_the_daemon_ends_looks_do),
		TEST(after_the_builder_stopped_nobody_looks),
		TEST(a_core_that_nobody_needs_goes),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

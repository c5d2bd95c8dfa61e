// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a session that is rewound while other requests arrive. If the rewind fails, the session is
// as before.
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "server/hosted_session/hosted_fixture.h"

enum { CREATED, STEPPED, BACK, OTHER, NEXT };
// TICKS: number of ticks that the session is stepped, after which it has a checkpoint. BACK_TICK:
// tick of the rewind.
enum { TICKS = 40, BACK_TICK = 5 };

static void step(int asked, int64_t ticks)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_STEP, CAU_METHOD_SESSION_STEP);
	order->as.ticks = ticks;
	hosted_submit(order);
	assert_int_equal(hosted_await(asked)->status, CAU_OK);
}

// Rewinds a session from TICKS to BACK_TICK. The builder stops at `held_at`.
static void go_back(int held_at)
{
	hosted_begin(NOWHERE, CREATED);
	assert_int_equal(hosted_await(CREATED)->status, CAU_OK);
	step(STEPPED, TICKS);
	t.held_at = held_at;
	cau_order *order = hosted_new_order(BACK, CAU_ORDER_REWIND, CAU_METHOD_SESSION_REWIND);
	order->as.tick = BACK_TICK;
	hosted_submit(order);
	if (held_at != NOWHERE)
		pthread_barrier_wait(&t.met);
}

static void set_gravity(int asked)
{
	cau_order *order = hosted_new_order(asked, CAU_ORDER_COMMAND, CAU_METHOD_SET_GRAVITY);
	cau_default_command(&order->as.command, CAU_COMMAND_SET_GRAVITY);
	hosted_submit(order);
}

static cau_status take_hash(void *user, const cau_store_checkpoint *checkpoint)
{
	assert_int_equal(checkpoint->tick, TICKS);
	*(uint64_t *)user = checkpoint->hash;
	return CAU_OK;
}

// Checks that the session is as after the steps. No thread uses it any more.
static void assert_as_it_was(void)
{
	uint64_t hash = 0;
	while (t.h->suspension.active)
		sched_yield();
	cau_hosted_stop(t.h);
	cau_store_flush(t.around.store);
	assert_int_equal(
		cau_store_read_checkpoint(t.around.store, "d1-building", 0, TICKS, take_hash, &hash, NULL),
		CAU_OK);
	assert_int_equal(t.h->core.tick, TICKS);
	assert_true(cau_session_hash(t.h->core.session) == hash);
	cau_hosted_release(t.h);
	t.h = NULL;
}

static void assert_tick(int asked, int tick)
{
	char member[32];
	snprintf(member, sizeof member, "\"tick\":%d", tick);
	const hosted_answer *answered = hosted_await(asked);
	assert_int_equal(answered->status, CAU_OK);
	assert_non_null(strstr(answered->text, member));
}

static void what_is_asked_meanwhile_is_done_where_it_arrives(void **state)
{
	(void)state;
	cau_wire_session_summary summary;
	go_back(AT_RESTORE);
	cau_hosted_summary(t.h, &summary);
	assert_string_equal(summary.stage, "restoring");
	assert_int_equal(summary.state, CAU_SESSION_PAUSED);
	set_gravity(OTHER);
	hosted_go_on();
	assert_tick(BACK, BACK_TICK);
	assert_tick(OTHER, BACK_TICK);
	cau_hosted_summary(t.h, &summary);
	assert_false(summary.has_stage);
}

static void where_it_cannot_be_reached_it_stays(void **state)
{
	(void)state;
	t.fail_restore = true;
	go_back(NOWHERE);
	assert_int_equal(hosted_await(BACK)->status, CAU_NUMERICAL);
	assert_as_it_was();
}

static void where_it_stays_it_goes_on_with_what_was_asked(void **state)
{
	(void)state;
	t.fail_restore = true;
	go_back(AT_RESTORE);
	set_gravity(OTHER);
	hosted_go_on();
	assert_int_equal(hosted_await(BACK)->status, CAU_NUMERICAL);
	assert_tick(OTHER, TICKS);
	step(NEXT, 1);
	assert_tick(NEXT, TICKS + 1);
}

static void destroyed_while_it_goes_back_it_ends(void **state)
{
	(void)state;
	go_back(AT_RESTORE);
	hosted_destroy(OTHER, 0);
	hosted_turn_off_at_tick_1000(NEXT);
	hosted_go_on();
	assert_non_null(strstr(hosted_await(BACK)->reason, "while it was rewound, before replaying"));
	assert_int_equal(hosted_await(OTHER)->status, CAU_OK);
	assert_int_equal(hosted_await(NEXT)->code, CAU_RPC_NOT_HERE);
	assert_true(cau_hosted_ended(t.h));
	assert_int_equal(hosted_stored_sessions(), 0);
}

static void as_the_daemon_ends_it_stays(void **state)
{
	(void)state;
	go_back(AT_RESTORE);
	cau_hosted_drain(t.h);
	hosted_go_on();
	assert_int_equal(hosted_await(BACK)->code, CAU_RPC_DRAINING);
	while (!cau_hosted_drained(t.h))
		sched_yield();
	assert_as_it_was();
}

static void after_the_builder_stopped_it_stays(void **state)
{
	(void)state;
	hosted_begin(NOWHERE, CREATED);
	assert_int_equal(hosted_await(CREATED)->status, CAU_OK);
	step(STEPPED, TICKS);
	cau_builder_stop(t.around.builder);
	cau_order *order = hosted_new_order(BACK, CAU_ORDER_RESET, CAU_METHOD_SESSION_RESET);
	hosted_submit(order);
	assert_non_null(strstr(hosted_await(BACK)->reason, "the daemon is ending"));
	set_gravity(OTHER);
	assert_tick(OTHER, TICKS);
	assert_as_it_was();
}

int main(void)
{
#define TEST(function)                                                                             \
	cmocka_unit_test_setup_teardown(function, hosted_open_surroundings, hosted_close_surroundings)
	const struct CMUnitTest tests[] = {
		TEST(what_is_asked_meanwhile_is_done_where_it_arrives),
		TEST(where_it_cannot_be_reached_it_stays),
		TEST(where_it_stays_it_goes_on_with_what_was_asked),
		TEST(destroyed_while_it_goes_back_it_ends),
		TEST(as_the_daemon_ends_it_stays),
		TEST(after_the_builder_stopped_it_stays),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

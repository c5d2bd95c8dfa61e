// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a machine of which one value is corrupted. In every build the session is then faulted, its
// tool's energy is cut off, and every request is answered. The session works again after a rewind.
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "session/logic.h"

enum { CAPACITY = 8, DRIVER = 3, ACTS_MOST = 100 };

typedef struct spoilt {
	cau_logic *logic;
	cau_effects effects;
	cau_action action;
	double now_s;
	int cuts, refused, done;
} spoilt;

static void note_effects(spoilt *s)
{
	for (int32_t i = 0; i < s->effects.count; i++)
		s->refused += s->effects.list[i].kind == CAU_EFFECT_REFUSE;
}

static void take(spoilt *s, cau_logic_event event)
{
	event.time_s = s->now_s;
	cau_logic_take(s->logic, &event, &s->effects);
	note_effects(s);
}

static void ask(spoilt *s, uint64_t ticket, cau_ask what)
{
	cau_asked asked = {.ticket = ticket,
	                   .ask = what,
	                   .asker = {.client = DRIVER, .role = CAU_ROLE_ADMIN, .deadline_s = 1e6},
	                   .tool = "hook",
	                   .ticks = 1,
	                   .speed = 1};
	take(s, (cau_logic_event){.kind = CAU_LOGIC_ORDER, .asked = &asked});
}

// Lets the worker act until it has nothing to do.
static void work(spoilt *s)
{
	for (int i = 0; i < ACTS_MOST; i++) {
		cau_logic_next(s->logic, s->now_s, &s->action, &s->effects);
		note_effects(s);
		if (s->action.act == CAU_ACT_NOTHING)
			return;
		s->cuts += s->action.act == CAU_ACT_CUT;
		s->refused += s->action.act == CAU_ACT_REFUSE;
		s->done += s->action.act == CAU_ACT_ORDER;
		if (s->action.act == CAU_ACT_STEP)
			cau_logic_stepped(s->logic, s->now_s, NULL, &s->effects);
		else
			cau_logic_done(s->logic, s->now_s, CAU_DONE, &s->effects);
		note_effects(s);
	}
	fail_msg("the worker never comes to rest");
}

static void arrive(spoilt *s, bool energized)
{
	const cau_arrived_tool tool = {"hook", energized};
	take(s, (cau_logic_event){.kind = CAU_LOGIC_ARRIVED,
	                          .state = CAU_SESSION_RUNNING,
	                          .step_s = 0.01,
	                          .tools = &tool,
	                          .tool_count = 1});
}

// Returns a running session whose hook has a driver and energy on.
static spoilt begin(void)
{
	spoilt s = {.logic = malloc(cau_logic_bytes(CAPACITY)), .now_s = 1};
	assert_non_null(s.logic);
	cau_logic_init(s.logic, CAPACITY);
	arrive(&s, false);
	ask(&s, 1, CAU_ASK_TAKE_OVER);
	work(&s);
	ask(&s, 2, CAU_ASK_ENERGY_ON);
	work(&s);
	assert_true(s.logic->drives[0].enabled);
	s.cuts = s.refused = s.done = 0;
	return s;
}

// ---- corruptions --------------------------------------------------------------------------------

static void spoil_steps(cau_logic *logic)
{
	logic->steps_left = -3;
}

static void spoil_energized(cau_logic *logic)
{
	logic->drives[0].energized = false;
}

static void spoil_driver(cau_logic *logic)
{
	logic->drives[0].driver.client = 0;
}

static void spoil_moment(cau_logic *logic)
{
	logic->all_off_moment = logic->moment + 100;
}

static void spoil_cut(cau_logic *logic)
{
	logic->drives[0].cut_moment = logic->moment + 100;
}

static void spoil_name(cau_logic *logic)
{
	memset(logic->drives[0].tool, 0, sizeof logic->drives[0].tool);
}

static void spoil_drives(cau_logic *logic)
{
	logic->drive_count = CAU_MAX_TOOLS + 1;
}

static void spoil_count(cau_logic *logic)
{
	logic->count = -1;
}

static void spoil_count_upwards(cau_logic *logic)
{
	logic->count = 2 * CAPACITY + 1;
}

static void spoil_time(cau_logic *logic)
{
	logic->step_s = 0;
}

static void spoil_speed(cau_logic *logic)
{
	logic->speed = -1;
}

static const struct {
	void (*spoil)(cau_logic *logic);
	bool keeps_tool; // the corrupted machine still knows the hook
} cases[] = {
	{spoil_steps, true},   {spoil_energized, true}, {spoil_driver, true},
	{spoil_moment, true},  {spoil_cut, true},       {spoil_name, false},
	{spoil_drives, false}, {spoil_count, true},     {spoil_count_upwards, true},
	{spoil_time, true},    {spoil_speed, true},
};
enum { CASES = sizeof cases / sizeof *cases };

// ---- tests --------------------------------------------------------------------------------------

static void expect_off(const spoilt *s)
{
	assert_int_equal(s->logic->state, CAU_SESSION_FAULTED);
	assert_true(*s->logic->broken);
	for (int32_t i = 0; i < s->logic->drive_count; i++)
		assert_false(s->logic->drives[i].enabled);
}

// Checks that the machine is safe, whichever call found the corruption.
static void expect_safe(spoilt *s, bool keeps_tool)
{
	expect_off(s);
	work(s);
	expect_off(s);
	assert_int_equal(s->cuts, keeps_tool);
	ask(s, 50, CAU_ASK_ENERGY_ON);
	work(s);
	expect_off(s);
	s->refused = s->done = 0;
	ask(s, 51, CAU_ASK_RESUME);
	work(s);
	assert_int_equal(s->refused, 1);
	assert_int_equal(s->done, 0);
	ask(s, 52, CAU_ASK_GO);
	work(s);
	assert_int_equal(s->done, 1);
	arrive(s, false);
	work(s);
	assert_int_equal(s->logic->state, CAU_SESSION_RUNNING);
	assert_false(*s->logic->broken);
	free(s->logic);
}

static void an_event_finds_it(void **state)
{
	(void)state;
	for (int i = 0; i < CASES; i++) {
		spoilt s = begin();
		cases[i].spoil(s.logic);
		take(&s, (cau_logic_event){.kind = CAU_LOGIC_TIME});
		expect_safe(&s, cases[i].keeps_tool);
	}
}

static void an_order_that_finds_it_is_answered(void **state)
{
	(void)state;
	for (int i = 0; i < CASES; i++) {
		spoilt s = begin();
		cases[i].spoil(s.logic);
		ask(&s, 40, CAU_ASK_TISSUE);
		expect_off(&s);
		work(&s);
		assert_int_equal(s.refused, 1);
		assert_int_equal(s.done, 0);
		expect_safe(&s, cases[i].keeps_tool);
	}
}

static void the_worker_finds_it(void **state)
{
	(void)state;
	for (int i = 0; i < CASES; i++) {
		spoilt s = begin();
		s.now_s += 1;
		cases[i].spoil(s.logic);
		cau_logic_next(s.logic, s.now_s, &s.action, &s.effects);
		assert_int_equal(s.action.act, CAU_ACT_NOTHING);
		expect_safe(&s, cases[i].keeps_tool);
	}
}

static void the_end_of_a_tick_finds_it(void **state)
{
	(void)state;
	for (int i = 0; i < CASES; i++) {
		spoilt s = begin();
		s.now_s += 1;
		cau_logic_next(s.logic, s.now_s, &s.action, &s.effects);
		assert_int_equal(s.action.act, CAU_ACT_STEP);
		cases[i].spoil(s.logic);
		cau_logic_stepped(s.logic, s.now_s, NULL, &s.effects);
		expect_safe(&s, cases[i].keeps_tool);
	}
}

static void acts_out_of_order_are_found(void **state)
{
	(void)state;
	spoilt s = begin();
	cau_logic_done(s.logic, s.now_s, CAU_DONE, &s.effects); // a call although no act is under way
	expect_safe(&s, true);
	s = begin();
	s.now_s += 1;
	cau_logic_next(s.logic, s.now_s, &s.action, &s.effects);
	cau_logic_next(s.logic, s.now_s, &s.action, &s.effects); // a second call before the act is done
	assert_int_equal(s.action.act, CAU_ACT_NOTHING);
	expect_safe(&s, true);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_event_finds_it),
		cmocka_unit_test(an_order_that_finds_it_is_answered),
		cmocka_unit_test(the_worker_finds_it),
		cmocka_unit_test(the_end_of_a_tick_finds_it),
		cmocka_unit_test(acts_out_of_order_are_found),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

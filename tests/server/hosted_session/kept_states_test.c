// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that kept states of the past stay within their budget and are thinned out evenly.
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#include "hosted_session/past_views.h"

enum { BYTES = 100, BUDGET = 1000 };

static void put(cau_kept_states *kept, int64_t branch, uint64_t tick)
{
	cau_kept_state state = {
		.tick = tick, .exact = true, .bytes = malloc(BYTES), .byte_count = BYTES};
	assert_non_null(state.bytes);
	cau_kept_states_put(kept, BUDGET, branch, &state);
}

static void assert_found(const cau_kept_states *kept, uint64_t wanted, int64_t tick)
{
	const cau_kept_state *found = cau_kept_states_find(kept, kept->branch, wanted);
	if (tick < 0)
		assert_null(found);
	else
		assert_true(found && found->tick == (uint64_t)tick);
}

static void test_the_newest_before_a_tick_is_found(void **state)
{
	(void)state;
	static cau_kept_states kept;
	assert_found(&kept, 5, -1);
	for (uint64_t tick = 30; tick <= 90; tick += 30)
		put(&kept, 0, tick);
	assert_found(&kept, 29, -1);
	assert_found(&kept, 30, 30);
	assert_found(&kept, 89, 60);
	assert_found(&kept, 1000, 90);
	put(&kept, 0, 60); // replaces the state of the same tick
	assert_int_equal(kept.count, 3);
	assert_null(cau_kept_states_find(&kept, 1, 90));
	cau_kept_states_finish(&kept);
}

static void test_a_budget_holds_and_gaps_grow_evenly(void **state)
{
	(void)state;
	static cau_kept_states kept;
	for (uint64_t tick = 1; tick <= 1000; tick++) {
		put(&kept, 0, tick);
		assert_true(kept.byte_count <= BUDGET);
	}
	assert_int_equal(kept.count, BUDGET / BYTES);
	uint64_t widest = 0;
	for (int32_t i = 1; i < kept.count; i++) {
		assert_true(kept.state[i].tick > kept.state[i - 1].tick);
		uint64_t gap = kept.state[i].tick - kept.state[i - 1].tick;
		widest = gap > widest ? gap : widest;
	}
	// the widest gap is at most four times the gap of an even distribution
	assert_true(widest <= 4 * 1000 / (BUDGET / BYTES));
	cau_kept_states_finish(&kept);
}

static void test_what_was_kept_of_a_line_that_is_left_goes(void **state)
{
	(void)state;
	static cau_kept_states kept;
	put(&kept, 0, 10);
	put(&kept, 1, 20);
	assert_int_equal(kept.count, 1);
	assert_int_equal(kept.byte_count, BYTES);
	assert_found(&kept, 19, -1);
	assert_found(&kept, 20, 20);
	cau_kept_states_finish(&kept);
	assert_int_equal(kept.byte_count, 0);
}

static void test_what_is_larger_than_the_budget_is_not_kept(void **state)
{
	(void)state;
	static cau_kept_states kept;
	cau_kept_state large = {.tick = 1, .bytes = malloc(1), .byte_count = BUDGET + 1};
	cau_kept_states_put(&kept, BUDGET, 0, &large);
	assert_int_equal(kept.count, 0);
	for (uint64_t tick = 0; tick < 2 * CAU_KEPT_STATES_MOST; tick++) {
		cau_kept_state small = {.tick = tick, .bytes = malloc(1), .byte_count = 1};
		cau_kept_states_put(&kept, BUDGET, 0, &small);
	}
	assert_int_equal(kept.count, CAU_KEPT_STATES_MOST);
	cau_kept_states_finish(&kept);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_the_newest_before_a_tick_is_found),
		cmocka_unit_test(test_a_budget_holds_and_gaps_grow_evenly),
		cmocka_unit_test(test_what_was_kept_of_a_line_that_is_left_goes),
		cmocka_unit_test(test_what_is_larger_than_the_budget_is_not_kept),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

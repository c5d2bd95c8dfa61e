// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged volumes inside and outside a region; and whether commands would be accepted.
#include "core/session/stage.h"

#include <string.h>

static const double rounding = 1e-12; // largest relative error of a volume

static cau_session *burning(void)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	cau_sheet_material *sheet = stage_add_sheet(scene, "fascia", 0.02, 0.02, 10, 10)->sheet;
	sheet->thickness_m = 0.001;
	sheet->heat.ignition_c = 60;
	sheet->heat.absorption_per_s = 20;
	stage_add_tool(scene, "hook", CAU_TOOL_HOOK, 0, 0, 0);
	cau_session *session = stage_open(scene, 1);
	free(scene);
	return session;
}

static cau_selection ball(double radius_m)
{
	return (cau_selection){.kind = CAU_SELECT_SPHERE, .radius_m = radius_m};
}

static void test_inside_and_outside_are_all_of_it(void **state)
{
	(void)state;
	cau_session *session = burning();
	stage_energize(session, "hook", 1);
	stage_step(session, 60);
	cau_damage inside, outside, whole, none;
	cau_selection part = ball(0.003), all = ball(1);
	cau_session_damage(session, &part, &inside, &outside);
	cau_session_damage(session, &all, &whole, &none);
	cau_frame frame = stage_frame(session);
	assert_true(frame.statistics.elements_removed > 0);
	assert_int_equal(whole.removed_count, frame.statistics.elements_removed);
	double triangle_m3 = 0.002 * 0.002 / 2 * 0.001;
	assert_true(fabs(whole.removed_m3 - whole.removed_count * triangle_m3) <
	            1e-9 * whole.removed_m3);
	assert_int_equal(inside.removed_count + outside.removed_count, whole.removed_count);
	assert_true(fabs(inside.damaged_m3 + outside.damaged_m3 - whole.damaged_m3) <=
	            rounding * whole.damaged_m3);
	assert_true(whole.damaged_m3 > 0 && whole.damaged_m3 + whole.removed_m3 < 0.02 * 0.02 * 0.001);
	assert_true(none.removed_count == 0 && none.damaged_m3 == 0);
	cau_session_destroy(session);
}

static void test_commands_are_checked_and_nothing_changes(void **state)
{
	(void)state;
	cau_session *session = burning();
	cau_command commands[2];
	cau_error error = {0};
	int32_t index = -1;
	uint64_t before = cau_session_hash(session);
	for (int i = 0; i < 2; i++) {
		cau_default_command(&commands[i], CAU_COMMAND_TOOL_MOVE);
		strcpy(commands[i].tool, "hook");
	}
	assert_int_equal(cau_session_may_submit(session, commands, 2, &index, &error), CAU_OK);
	assert_int_equal(cau_session_waiting(session, "hook"), 0);
	commands[1].as.move.jaw = 2;
	assert_int_equal(cau_session_may_submit(session, commands, 2, &index, &error), CAU_BAD_VALUE);
	assert_int_equal(index, 1);
	assert_int_equal(cau_session_waiting(session, "hook"), 0);
	assert_true(cau_session_hash(session) == before);
	commands[1].as.move.jaw = 0;
	while (cau_session_submit(session, &commands[0], &error) == CAU_OK) // fills the queue
		;
	assert_int_equal(cau_session_may_submit(session, commands, 1, &index, &error), CAU_LIMIT);
	cau_session_destroy(session);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_inside_and_outside_are_all_of_it),
		cmocka_unit_test(test_commands_are_checked_and_nothing_changes)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

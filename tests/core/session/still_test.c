// SPDX-License-Identifier: GPL-3.0-or-later
// Energy off and hold cannot fail, even with a full queue and whatever waits there. A log that
// holds them as commands replays with the same bits.
#include "core/session/stage.h"

#include "session/session_internal.h"

static void fill_queue(cau_session *session, uint64_t tick)
{
	cau_command gravity = stage_command(CAU_COMMAND_SET_GRAVITY);
	gravity.tick = tick;
	while (!cau_session_submit(session, &gravity, NULL))
		;
	assert_int_equal(session->queue.count, session->queue.capacity);
}

static cau_command energy(int on, uint64_t tick, int32_t ticks)
{
	cau_command command = stage_command(CAU_COMMAND_TOOL_ENERGIZE);
	command.as.energized = on;
	command.as.ticks = ticks;
	command.tick = tick;
	return command;
}

static bool is_on(const cau_session *session)
{
	return stage_tool(session, "hook")->energized;
}

static void off_and_hold_need_no_room(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	stage_energize(session, "hook", 1);
	stage_move(session, "hook", 0, 0, -1);
	stage_step(session, 3);
	assert_true(is_on(session));
	fill_queue(session, 100000);
	cau_session_energy_off(session, "hook", 0);
	cau_session_hold_still(session, "hook", 0);
	assert_false(is_on(session));
	cau_pose before = stage_tool(session, "hook")->asked_pose;
	stage_step(session, 5);
	assert_false(is_on(session));
	assert_memory_equal(&before, &stage_tool(session, "hook")->asked_pose, sizeof before);
	// An energy-off and a hold that are submitted as commands do the same.
	cau_command off = energy(0, 0, 0), hold = stage_command(CAU_COMMAND_TOOL_HOLD);
	session->tool[cau_session_find_tool(session, "hook")].state.energized = true;
	assert_int_equal(cau_session_submit(session, &off, NULL), CAU_OK);
	assert_int_equal(cau_session_submit(session, &hold, NULL), CAU_OK);
	assert_false(is_on(session));
	cau_session_destroy(session);
	free(scene);
}

static void an_off_voids_the_enables_that_wait(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	cau_command now = energy(1, 0, 0), later = energy(1, 4, 0), other = energy(1, 4, 0);
	strcpy(other.tool, "jaws");
	stage_submit(session, &now);
	stage_submit(session, &later);
	stage_submit(session, &other);
	assert_int_equal(cau_session_waiting(session, "hook"), 2);
	cau_session_energy_off(session, "hook", 0);
	assert_int_equal(cau_session_waiting(session, "hook"), 0);
	for (int tick = 0; tick < 8; tick++) {
		stage_step(session, 1);
		assert_false(is_on(session));
	}
	assert_true(stage_tool(session, "jaws")->energized); // the other tool's enable still waits
	cau_session_destroy(session);
	free(scene);
}

// An energy-off at a later tick voids the enables before it, and none after it.
static void a_later_off_voids_older_enables(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	cau_command older = energy(1, 6, 0), off = energy(0, 3, 0), newer = energy(1, 9, 0);
	stage_submit(session, &older);
	stage_submit(session, &off);
	stage_submit(session, &newer);
	stage_step(session, 9);
	assert_false(is_on(session));
	stage_step(session, 1);
	assert_true(is_on(session));
	cau_session_destroy(session);
	free(scene);
}

static void a_hold_voids_all_that_waits_for_its_tool(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	static const int kinds[] = {CAU_COMMAND_TOOL_MOVE, CAU_COMMAND_TOOL_GRASP,
	                            CAU_COMMAND_TOOL_RELEASE, CAU_COMMAND_TOOL_CONFIGURE,
	                            CAU_COMMAND_TOOL_REMOVE};
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
		cau_command command = stage_command(kinds[k]);
		strcpy(command.tool, "jaws");
		command.tick = 5;
		stage_submit(session, &command);
	}
	cau_pose before = stage_tool(session, "jaws")->asked_pose;
	assert_int_equal(cau_session_waiting(session, "jaws"), 5);
	cau_session_hold_still(session, "jaws", 0);
	assert_int_equal(cau_session_waiting(session, "jaws"), 0);
	stage_step(session, 10);
	assert_memory_equal(&before, &stage_tool(session, "jaws")->asked_pose, sizeof before);
	assert_false(stage_tool(session, "jaws")->grasping);
	cau_session_destroy(session);
	free(scene);
}

static void a_removal_voids_what_waits_for_its_tool(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	cau_command later = energy(1, 5, 0), remove = stage_command(CAU_COMMAND_TOOL_REMOVE);
	cau_command add = stage_command(CAU_COMMAND_TOOL_ADD);
	strcpy(add.as.definition.name, "hook");
	stage_submit(session, &later);
	stage_submit(session, &remove);
	stage_submit(session, &add);
	stage_step(session, 10);
	assert_false(is_on(session));
	cau_session_destroy(session);
	free(scene);
}

// ---- limits

static int32_t ticks_on(cau_session *session, int32_t ticks)
{
	int32_t on = 0;
	for (int32_t tick = 0; tick < ticks; tick++) {
		stage_step(session, 1);
		on += is_on(session);
	}
	return on;
}

static void an_enable_ends_after_its_ticks(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	cau_command limited = energy(1, 0, 4), again = energy(1, 0, 6), on = energy(1, 0, 0);
	stage_submit(session, &limited);
	fill_queue(session, 100000); // the end of an enable needs no capacity
	assert_int_equal(ticks_on(session, 12), 4);
	session->queue.count = 0;
	// A newer enable replaces the limit of the enable before it, even by no limit.
	stage_submit(session, &limited);
	assert_int_equal(ticks_on(session, 2), 2);
	stage_submit(session, &again);
	assert_int_equal(ticks_on(session, 12), 6);
	stage_submit(session, &limited);
	assert_int_equal(ticks_on(session, 2), 2);
	stage_submit(session, &on);
	assert_int_equal(ticks_on(session, 12), 12);
	// An energy-off ends the enable, and the next enable is not limited by it.
	stage_submit(session, &limited);
	assert_int_equal(ticks_on(session, 1), 1);
	cau_session_energy_off(session, "hook", 0);
	stage_submit(session, &on);
	assert_int_equal(ticks_on(session, 12), 12);
	cau_session_destroy(session);
	free(scene);
}

static void a_limit_is_in_the_snapshot(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 1);
	cau_command limited = energy(1, 0, 5);
	bool exact;
	stage_submit(session, &limited);
	assert_int_equal(ticks_on(session, 2), 2);
	stage_bytes kept = stage_snapshot(session);
	assert_int_equal(cau_session_restore(other, kept.bytes, kept.count, &exact, NULL), CAU_OK);
	assert_int_equal(ticks_on(other, 10), 3);
	free(kept.bytes);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

static void a_negative_limit_is_refused(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	cau_command limited = energy(1, 0, -1), off = energy(0, 0, -1);
	cau_error error = {0};
	assert_int_equal(cau_session_submit(session, &limited, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "ticks");
	// An energy-off is not refused.
	assert_int_equal(cau_session_submit(session, &off, &error), CAU_OK);
	cau_session_destroy(session);
	free(scene);
}

// ---- the core reports which tools may heat

static void it_says_what_it_may_heat(void **state)
{
	(void)state;
	const char *const hook = "hook";
	cau_scene_def *scene = stage_layered();
	cau_session *session = stage_open(scene, 1);
	assert_null(cau_session_heats_beyond(session, NULL, 0));
	cau_command later = energy(1, 100, 0);
	stage_submit(session, &later);
	// The queued enable would let the hook heat later.
	assert_string_equal(cau_session_heats_beyond(session, NULL, 0), "hook");
	assert_null(cau_session_heats_beyond(session, &hook, 1));
	cau_session_energy_off(session, "hook", 0);
	assert_null(cau_session_heats_beyond(session, NULL, 0));
	stage_energize(session, "jaws", 1);
	stage_step(session, 1);
	assert_string_equal(cau_session_heats_beyond(session, &hook, 1), "jaws");
	cau_session_destroy(session);
	free(scene);
}

// ---- replay

// Submits a small log with all causes that void commands. In one run the causes are calls, in the
// other run commands.
static void act(cau_session *session, uint64_t tick, bool as_commands)
{
	cau_command on = energy(1, 0, 0), later = energy(1, tick + 3, 0), off = energy(0, 0, 0);
	cau_command hold = stage_command(CAU_COMMAND_TOOL_HOLD);
	cau_command move = stage_command(CAU_COMMAND_TOOL_MOVE);
	move.as.move.pose.position_m[0] = 0.01 * (double)(tick % 3);
	move.tick = tick + tick % 4;
	if (tick % 5 == 0)
		on.as.ticks = 2;
	stage_submit(session, &move);
	stage_submit(session, tick % 2 ? &on : &later);
	if (tick % 4 == 3) {
		if (as_commands)
			stage_submit(session, &off);
		else
			cau_session_energy_off(session, "hook", 0);
	}
	if (tick % 7 == 6) {
		if (as_commands)
			stage_submit(session, &hold);
		else
			cau_session_hold_still(session, "hook", 0);
	}
	// This enable follows the energy-off or hold at the same tick border.
	if (tick % 7 == 5)
		stage_submit(session, &on);
}

static void as_commands_they_give_the_same_bits(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	cau_session *live = stage_open(scene, 1), *replayed = stage_open(scene, 1);
	int32_t on = 0;
	for (uint64_t tick = 0; tick < 60; tick++) {
		act(live, tick, false);
		act(replayed, tick, true);
		stage_step(live, 1);
		stage_step(replayed, 1);
		on += is_on(live);
		assert_true(cau_session_hash(live) == cau_session_hash(replayed));
		assert_int_equal(live->queue.count, replayed->queue.count);
	}
	assert_in_range(on, 10, 50);
	stage_bytes one = stage_snapshot(live), two = stage_snapshot(replayed);
	assert_int_equal(one.count, two.count);
	assert_memory_equal(one.bytes, two.bytes, one.count);
	free(one.bytes);
	free(two.bytes);
	cau_session_destroy(live);
	cau_session_destroy(replayed);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(off_and_hold_need_no_room),
		cmocka_unit_test(an_off_voids_the_enables_that_wait),
		cmocka_unit_test(a_later_off_voids_older_enables),
		cmocka_unit_test(a_hold_voids_all_that_waits_for_its_tool),
		cmocka_unit_test(a_removal_voids_what_waits_for_its_tool),
		cmocka_unit_test(an_enable_ends_after_its_ticks),
		cmocka_unit_test(a_limit_is_in_the_snapshot),
		cmocka_unit_test(a_negative_limit_is_refused),
		cmocka_unit_test(it_says_what_it_may_heat),
		cmocka_unit_test(as_commands_they_give_the_same_bits),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

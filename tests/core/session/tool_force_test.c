// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on tools. The raw force belongs to the tick that the frame names. The filtered force
// follows the formula of protocol/README.md, with the tool's own time constant.
#include "core/session/stage.h"

#include "session/session_internal.h"

static const double radius_m = 0.006, first_m = 0.0065,
					way_m = 2e-4;     // m: radius and first height of a ball; its motion in a tick
static const double rounding = 1e-12; // largest relative error

// Returns a scene: a ball above a block of fat whose top is at z = 0.
static cau_scene_def *block_scene(double force_filter_s)
{
	const double size[3] = {0.03, 0.03, 0.012}, least[3] = {-1, -1, -0.0121},
				 most[3] = {1, 1, -0.0119};
	const int32_t cells[3] = {10, 10, 4};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	stage_add_slab(scene, "fat", size, cells);
	stage_pin_box(scene, least, most);
	cau_tool_def *ball = stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0, 0, first_m);
	ball->hot_radius_m = radius_m;
	ball->friction = 0.3;
	ball->force_filter_s = force_filter_s;
	return scene;
}

// Moves the ball down, along and up again, so that force and torque increase, rotate and vanish.
static void lead(cau_session *session, int tick)
{
	double in = way_m * (tick < 30 ? tick : fmax(60 - tick, 0)), along = way_m * tick / 4;
	stage_move(session, "ball", along, 0, first_m - in);
	stage_step(session, 1);
}

static void configure(cau_session *session, double force_filter_s)
{
	cau_command command = stage_command(CAU_COMMAND_TOOL_CONFIGURE);
	command.as.definition = stage_tool(session, "ball")->definition;
	command.as.definition.force_filter_s = force_filter_s;
	strcpy(command.tool, "ball");
	stage_submit(session, &command);
}

// The step that moves the ball into the tissue has the contact's force, not the step before or
// after it.
static void contact_is_felt_in_its_own_tick(void **state)
{
	(void)state;
	cau_scene_def *scene = block_scene(0.02);
	cau_session *session = stage_open(scene, 1);
	for (int tick = 1; tick <= 6; tick++) {
		double gap_m = first_m - way_m * tick - radius_m;
		lead(session, tick);
		const cau_tool_state *ball = stage_tool(session, "ball");
		assert_int_equal(stage_frame(session).tick, tick);
		print_message("tick %d: %.2g m above, %.4g N, filtered %.4g N\n", tick, gap_m,
		              ball->raw_force_n[2], ball->force_n[2]);
		assert_true(gap_m > 0 ? ball->raw_force_n[2] == 0 : ball->raw_force_n[2] > 0);
		assert_true((ball->force_n[2] != 0) == (ball->raw_force_n[2] != 0));
	}
	cau_session_destroy(session);
	free(scene);
}

static void without_a_filter_both_are_the_same_to_the_bit(void **state)
{
	(void)state;
	cau_scene_def *scene = block_scene(0);
	cau_session *session = stage_open(scene, 1);
	double most_nm = 0;
	for (int tick = 1; tick <= 70; tick++) {
		lead(session, tick);
		const cau_tool_state *ball = stage_tool(session, "ball");
		assert_memory_equal(ball->force_n, ball->raw_force_n, sizeof ball->force_n);
		assert_memory_equal(ball->torque_nm, ball->raw_torque_nm, sizeof ball->torque_nm);
		most_nm = fmax(most_nm, cau_length(cau_vec3_of(ball->torque_nm)));
	}
	assert_true(most_nm > 0 && stage_tool(session, "ball")->raw_force_n[2] == 0);
	cau_session_destroy(session);
	free(scene);
}

static void follow(double filtered[3], const double raw[3], double tau_s, double dt)
{
	for (int c = 0; c < 3; c++)
		filtered[c] += dt / (dt + tau_s) * (raw[c] - filtered[c]);
}

static void expect_near(const double is[3], const double should[3])
{
	cau_vec3 off = cau_sub(cau_vec3_of(is), cau_vec3_of(should));
	assert_true(cau_length(off) <= rounding * (1 + cau_length(cau_vec3_of(should))));
}

// The filter follows its formula with any time constant, from the tick at which the constant is
// set.
static void the_filter_follows_its_formula(void **state)
{
	(void)state;
	const double tau_s[] = {0.02, 1, 0.1, 0, 1e-3};
	cau_scene_def *scene = block_scene(tau_s[0]);
	cau_session *session = stage_open(scene, 1);
	double force_n[3] = {0}, torque_nm[3] = {0}, dt = stage_info(session).step_s;
	for (int tick = 1; tick <= 75; tick++) {
		int turn = (tick - 1) / 15;
		if ((tick - 1) % 15 == 0)
			configure(session, tau_s[turn]);
		lead(session, tick);
		const cau_tool_state *ball = stage_tool(session, "ball");
		follow(force_n, ball->raw_force_n, tau_s[turn], dt);
		follow(torque_nm, ball->raw_torque_nm, tau_s[turn], dt);
		expect_near(ball->force_n, force_n);
		expect_near(ball->torque_nm, torque_nm);
	}
	cau_session_destroy(session);
	free(scene);
}

// The bound of the filtered force does not apply to the raw force.
static void the_raw_force_has_no_bound(void **state)
{
	(void)state;
	cau_scene_def *scene = block_scene(0);
	scene->tools[0].force_max_n = 0.05;
	cau_session *session = stage_open(scene, 1);
	double most_n = 0;
	for (int tick = 1; tick <= 60; tick++) {
		lead(session, tick);
		const cau_tool_state *ball = stage_tool(session, "ball");
		most_n = fmax(most_n, cau_length(cau_vec3_of(ball->raw_force_n)));
		assert_true(cau_length(cau_vec3_of(ball->force_n)) <= 0.05 * (1 + rounding));
	}
	assert_true(most_n > 0.05);
	cau_session_destroy(session);
	free(scene);
}

// A snapshot holds the time constant that was set, and the filter's value.
static void a_restored_filter_goes_on(void **state)
{
	(void)state;
	cau_scene_def *scene = block_scene(0.02);
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 1);
	cau_error error = {0};
	bool exact = false;
	configure(session, 0.3);
	for (int tick = 1; tick <= 20; tick++)
		lead(session, tick);
	stage_bytes shot = stage_snapshot(session);
	assert_int_equal(cau_session_restore(other, shot.bytes, shot.count, &exact, &error), CAU_OK);
	assert_true(exact && stage_tool(other, "ball")->definition.force_filter_s == 0.3);
	for (int tick = 21; tick <= 30; tick++) {
		lead(session, tick);
		lead(other, tick);
		const double *is = stage_tool(other, "ball")->force_n;
		assert_memory_equal(is, stage_tool(session, "ball")->force_n, 3 * sizeof *is);
	}
	assert_int_equal(cau_session_hash(session), cau_session_hash(other));
	free(shot.bytes);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

// A slow filter keeps tissue awake until the filtered force has followed.
static void tissue_rests_once_the_filter_has_followed(void **state)
{
	(void)state;
	const int most_ticks = 3600;
	cau_scene_def *scene = block_scene(1);
	cau_session *session = stage_open(scene, 1);
	stage_move(session, "ball", 0, 0, first_m - 8 * way_m);
	int tick = 0;
	for (; tick < most_ticks && !stage_frame(session).statistics.resting; tick++)
		stage_step(session, 1);
	const cau_tool_state *ball = stage_tool(session, "ball");
	print_message("rest at tick %d: %.6g N, filtered %.6g N\n", tick, ball->raw_force_n[2],
	              ball->force_n[2]);
	assert_true(tick < most_ticks && ball->raw_force_n[2] > 0);
	assert_true(fabs(ball->force_n[2] - ball->raw_force_n[2]) <= 1e-3 * ball->raw_force_n[2]);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(contact_is_felt_in_its_own_tick),
		cmocka_unit_test(without_a_filter_both_are_the_same_to_the_bit),
		cmocka_unit_test(the_filter_follows_its_formula),
		cmocka_unit_test(the_raw_force_has_no_bound),
		cmocka_unit_test(a_restored_filter_goes_on),
		cmocka_unit_test(tissue_rests_once_the_filter_has_followed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws hold what is between them, be they smaller than a cell; say that they slip, or that they are
// empty; and nothing jumps when they close.
#include "core/session/stage.h"
#include "session/session_internal.h"

// Jaws 2 mm wide and 4 mm long over cells of 10 mm, half way between vertices.
static cau_scene_def *coarse_scene(double x, double y, double z)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	stage_add_sheet(scene, "sheet", 0.06, 0.05, 6, 5)->sheet[0].limit_stiffness_pa = 1e6;
	cau_selection *rim = &scene->pins[scene->pin_count++];
	cau_default_selection(rim, CAU_SELECT_RIM);
	cau_tool_def *jaws = stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, x, y, z);
	jaws->shaft_radius_m = 1e-3;
	jaws->tip_length_m = 4e-3;
	return scene;
}

static cau_vec3 center_of_holds(const cau_session *session)
{
	const cau_tool *tool = &session->tool[0];
	cau_vec3 sum = {0, 0, 0};
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		cau_contact_row row = cau_session_row_of_hold(session, &tool->grasp[k], 0);
		sum = cau_add_scaled(sum, 1.0 / tool->grasp_count,
		                     cau_contact_point(&row, session->position));
	}
	return sum;
}

static void jaws_smaller_than_a_cell_hold_and_pull(void **state)
{
	(void)state;
	const double way_m = 4e-3, speed_m = 2e-4, near_m = 1.5e-3;
	cau_scene_def *scene = coarse_scene(0.004, 0.003, -0.002);
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 4);
	stage_step(session, 2);
	stage_grasp(session, "jaws");
	size_t bytes = 3 * (size_t)stage_info(session).vertex_count * sizeof(double);
	double *before = malloc(bytes);
	assert_non_null(before);
	memcpy(before, stage_frame(session).position, bytes);
	for (int tick = 0; tick < 20; tick++) { // while the jaws close
		stage_step(session, 1);
		cau_frame frame = stage_frame(session);
		assert_true(stage_farthest(&frame, before, stage_info(session).vertex_count) < 1e-4);
	}
	int32_t held = stage_tool(session, "jaws")->grasped_vertices;
	assert_in_range(held, 1, 4);
	assert_true(session->tool[0].grasp[0].face >= 0);
	assert_true(stage_tool(session, "jaws")->jaw == 0);
	cau_vec3 start = center_of_holds(session);
	for (int tick = 1; tick <= 40; tick++) {
		stage_move(session, "jaws", 0.004, 0.003, -0.002 + fmin(speed_m * tick, way_m));
		stage_step(session, 1);
		if (tick == 20) { // holds on faces are in snapshots
			stage_bytes shot = stage_snapshot(session);
			bool exact = false;
			cau_error error = {0};
			assert_int_equal(cau_session_restore(other, shot.bytes, shot.count, &exact, &error),
			                 CAU_OK);
			assert_true(exact);
			free(shot.bytes);
		}
		if (tick > 20) {
			stage_move(other, "jaws", 0.004, 0.003, -0.002 + fmin(speed_m * tick, way_m));
			stage_step(other, 1);
			assert_true(cau_session_hash(other) == cau_session_hash(session));
		}
	}
	// The tissue goes with the jaws, but for what the hold yields, and they feel it.
	cau_vec3 way = cau_sub(center_of_holds(session), start);
	assert_true(fabs(way.z - way_m) < near_m);
	assert_true(stage_tool(session, "jaws")->force_n[2] < -0.05);
	assert_int_equal(stage_tool(session, "jaws")->grasped_vertices, held);
	free(before);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

static void empty_jaws_close_whole_and_say_so(void **state)
{
	(void)state;
	cau_scene_def *scene = coarse_scene(0.004, 0.003, 0.02);
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 30);
	const cau_tool_state *jaws = stage_tool(session, "jaws");
	assert_true(jaws->grasping && !jaws->slipping);
	assert_int_equal(jaws->grasped_vertices, 0);
	assert_true(jaws->jaw == 0);
	cau_session_destroy(session);
	free(scene);
}

static void what_is_pulled_too_hard_slips_and_is_lost(void **state)
{
	(void)state;
	cau_scene_def *scene = coarse_scene(0.004, 0.003, -0.002);
	scene->tools[0].slip_force_n = 0.05;
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 20);
	assert_true(stage_tool(session, "jaws")->grasped_vertices > 0);
	int32_t slips = 0;
	for (int tick = 1; tick <= 100 && stage_tool(session, "jaws")->grasped_vertices; tick++) {
		stage_move(session, "jaws", 0.004, 0.003, -0.002 + 2e-4 * tick);
		stage_step(session, 1);
		slips += stage_tool(session, "jaws")->slipping;
	}
	assert_true(slips > 5);
	assert_int_equal(stage_tool(session, "jaws")->grasped_vertices, 0);
	cau_session_destroy(session);
	free(scene);
}

// A face that tears or burns takes its holds along.
static void a_hold_goes_with_its_face(void **state)
{
	(void)state;
	cau_scene_def *scene = coarse_scene(0.004, 0.003, -0.002);
	scene->layers[0].sheet[0].heat.tear_energy_j_m2 = 1; // hardly anything
	scene->tools[0].slip_force_n = 1000;
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 20);
	assert_true(stage_tool(session, "jaws")->grasped_vertices > 0);
	for (int tick = 1; tick <= 100 && stage_tool(session, "jaws")->grasped_vertices; tick++) {
		stage_move(session, "jaws", 0.004, 0.003, -0.002 + 2e-4 * tick);
		stage_step(session, 1);
	}
	assert_true(stage_frame(session).statistics.elements_torn > 0);
	assert_int_equal(stage_tool(session, "jaws")->grasped_vertices, 0);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(jaws_smaller_than_a_cell_hold_and_pull),
		cmocka_unit_test(empty_jaws_close_whole_and_say_so),
		cmocka_unit_test(what_is_pulled_too_hard_slips_and_is_lost),
		cmocka_unit_test(a_hold_goes_with_its_face),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

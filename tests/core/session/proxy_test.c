// SPDX-License-Identifier: GPL-3.0-or-later
// A tool has a commanded pose and an actual pose (core/DECISIONS.md, "Contact"). Tissue that does
// not yield stops the tool, up to force_max_n. Beyond that the tool stays behind, until it releases
// the tissue and jumps to its commanded pose.
#include <stdio.h>

#include "core/session/pressing.h"
#include "solve/contact.h"

static cau_vec3 behind(const cau_tool_state *tool)
{
	return cau_sub(cau_vec3_of(tool->pose.position_m), cau_vec3_of(tool->asked_pose.position_m));
}

static void what_nothing_touches_is_where_it_is_asked_to_be(void **state)
{
	(void)state;
	static const pressing away = {PRESSING_SHEET, CAU_TOOL_SPHERE, 1.5e-3, 2e-3, 0.1, 0, 0};
	cau_scene_def *scene = pressing_scene(&away);
	cau_session *session = stage_open(scene, 1);
	for (int tick = 0; tick < 20; tick++) {
		stage_move(session, "tool", 1e-3 * tick, -7e-4 * tick, 0.01 + 1e-3 * tick);
		stage_step(session, 1);
		const cau_tool_state *tool = stage_tool(session, "tool");
		assert_memory_equal(&tool->pose, &tool->asked_pose, sizeof tool->pose);
	}
	cau_session_destroy(session);
	free(scene);
}

// In each tick the force on the tool is that of the coupling's spring.
static void it_is_off_by_what_it_feels(void **state)
{
	(void)state;
	const double settled = 2e-3; // share of the force that a step's last increment changes
	static const pressing p = {PRESSING_SLAB, CAU_TOOL_SPHERE, 3e-3, 2.5e-3, 0.05, 4e-3, 5};
	cau_scene_def *scene = pressing_scene(&p);
	cau_session *session = stage_open(scene, 1);
	int felt = 0;
	for (int tick = 0; tick < 20; tick++) {
		pressing_move(session, &p, pressing_depth_m(&p, tick));
		stage_step(session, 1);
		const cau_tool_state *tool = stage_tool(session, "tool");
		cau_vec3 force = cau_vec3_of(tool->raw_force_n);
		cau_vec3 off = cau_scale(cau_coupling_reach_m / p.force_max_n, force);
		assert_true(cau_length(cau_sub(behind(tool), off)) <= settled * cau_length(off) + 1e-12);
		felt += cau_length(force) > 0.01;
	}
	assert_true(felt > 5);
	cau_session_destroy(session);
	free(scene);
}

// A tool is pressed farther than the slab is deep. The pinned bottom stops the tool, which then
// pushes with its full force. Crushed tissue needs more iterations than the other scenes of tests.
static void tissue_that_cannot_yield_stops_it(void **state)
{
	(void)state;
	enum { ITERATIONS = 40 };
	static const pressing p = {PRESSING_SLAB, CAU_TOOL_SPHERE, 1.5e-3, 2e-3, 0.08, 0.022, 0};
	cau_scene_def *scene = pressing_scene(&p);
	scene->iterations = ITERATIONS;
	cau_session *session = stage_open(scene, 1);
	for (int tick = 0; tick < 30 + (int)(60 * p.depth_m / p.speed_m_s); tick++) {
		pressing_move(session, &p, pressing_depth_m(&p, tick));
		stage_step(session, 1);
		assert_false(pressing_is_crossed(session));
	}
	const cau_tool_state *tool = stage_tool(session, "tool");
	print_message("at %.2f mm, asked for %.2f, %.2f N\n", 1e3 * tool->pose.position_m[2],
	              1e3 * tool->asked_pose.position_m[2], tool->raw_force_n[2]);
	assert_true(tool->pose.position_m[2] > -pressing_deep_m);
	assert_true(fabs(tool->raw_force_n[2] / tool->definition.force_max_n - 1) < 0.01);
	assert_int_equal(tool->slips, 0);
	cau_session_destroy(session);
	free(scene);
}

// A tool with little force moves until the tissue resists with that force, and no farther.
static void it_pushes_with_what_it_has(void **state)
{
	(void)state;
	static const pressing p = {PRESSING_SLAB, CAU_TOOL_SPHERE, 3e-3, 2.5e-3, 0.1, 0.01, 0.05};
	cau_scene_def *scene = pressing_scene(&p);
	cau_session *session = stage_open(scene, 1);
	double most = 0;
	for (int tick = 0; tick < 90; tick++) {
		pressing_move(session, &p, pressing_depth_m(&p, tick));
		stage_step(session, 1);
		most = fmax(most, cau_length(cau_vec3_of(stage_tool(session, "tool")->raw_force_n)));
		assert_false(pressing_is_crossed(session));
	}
	const cau_tool_state *tool = stage_tool(session, "tool");
	assert_true(most < 1.02 * p.force_max_n);
	assert_true(cau_length(cau_vec3_of(tool->raw_force_n)) > 0.99 * p.force_max_n);
	assert_true(cau_length(behind(tool)) > 1.5 * cau_coupling_reach_m);
	cau_session_destroy(session);
	free(scene);
}

static void left_behind_too_far_it_lets_go(void **state)
{
	(void)state;
	static const pressing p = {PRESSING_SLAB, CAU_TOOL_SPHERE, 3e-3, 2.5e-3, 0.1, 0.06, 0.05};
	cau_scene_def *scene = pressing_scene(&p);
	cau_session *session = stage_open(scene, 1);
	double most_behind = 0;
	for (int tick = 0; tick < 60; tick++) {
		pressing_move(session, &p, pressing_depth_m(&p, tick));
		stage_step(session, 1);
		most_behind = fmax(most_behind, cau_length(behind(stage_tool(session, "tool"))));
	}
	const cau_tool_state *tool = stage_tool(session, "tool");
	assert_int_equal(tool->slips, 1);
	assert_true(most_behind < 0.045);
	assert_true(tool->pose.position_m[2] < -2 * pressing_deep_m);
	cau_session_destroy(session);
	free(scene);
}

// The actual pose is the same on other threads, and after a restore at each tick, also of ticks
// that began again.
static void where_it_is_is_part_of_the_state(void **state)
{
	(void)state;
	static const pressing p = {PRESSING_SLAB, CAU_TOOL_SPHERE, 1.5e-3, 2e-3, 1, 0.02, 0};
	cau_scene_def *scene = pressing_scene(&p);
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 2);
	int held_back = 0;
	for (int tick = 0; tick < 20; tick++) {
		stage_bytes shot = stage_snapshot(session);
		cau_error error = {0};
		bool exact = false;
		if (cau_session_restore(other, shot.bytes, shot.count, &exact, &error))
			fail_msg("%s", error.reason);
		free(shot.bytes);
		assert_true(exact);
		pressing_move(session, &p, pressing_depth_m(&p, tick));
		pressing_move(other, &p, pressing_depth_m(&p, tick));
		stage_step(session, 1);
		stage_step(other, 1);
		held_back += session->contact.tool[0].held_back;
		assert_true(cau_session_hash(session) == cau_session_hash(other));
		const cau_tool_state *a = &session->tool[0].state, *b = &other->tool[0].state;
		assert_memory_equal(&a->asked_pose, &b->asked_pose, sizeof a->asked_pose);
		assert_memory_equal(&session->tool[0].anchor, &other->tool[0].anchor, sizeof(cau_pose));
	}
	assert_true(held_back > 0);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

// When a ball's energy goes off while it is inside tissue, the tissue pushes it out at a tenth of a
// metre a second.
static void it_is_let_out_slowly(void **state)
{
	(void)state;
	// Largest motion of a vertex in a tick: twice that of the tool, because pushed tissue drags its
	// neighbourhood along.
	const double most_m = 2 * 0.1 / 60;
	static const pressing p = {PRESSING_SLAB, CAU_TOOL_SPHERE, 6e-3, 2e-3, 0.1, 0, 0};
	cau_scene_def *scene = pressing_scene(&p);
	// The ball is at ambient temperature, so that it enters the tissue and cuts nothing.
	scene->tools[0].temperature_c = scene->ambient_c;
	scene->tools[0].shaft_radius_m = 1e-3;
	cau_session *session = stage_open(scene, 1);
	stage_energize(session, "tool", 1);
	pressing_move(session, &p, 6e-3);
	stage_step(session, 30);
	stage_energize(session, "tool", 0);
	double most = 0, way = 0;
	for (int tick = 0; tick < 30; tick++) {
		stage_step(session, 1);
		for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++)
			most = fmax(most, cau_length(cau_sub(cau_vec3_of(session->vertices.position + 3 * v),
			                                     cau_vec3_of(session->vertices.start + 3 * v))));
		way += most;
	}
	print_message("at most %.2f mm in a tick\n", 1e3 * most);
	assert_true(way > 2e-3);
	assert_true(most < most_m);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_nothing_touches_is_where_it_is_asked_to_be),
		cmocka_unit_test(it_is_off_by_what_it_feels),
		cmocka_unit_test(tissue_that_cannot_yield_stops_it),
		cmocka_unit_test(it_pushes_with_what_it_has),
		cmocka_unit_test(left_behind_too_far_it_lets_go),
		cmocka_unit_test(where_it_is_is_part_of_the_state),
		cmocka_unit_test(it_is_let_out_slowly),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

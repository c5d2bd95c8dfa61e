// SPDX-License-Identifier: GPL-3.0-or-later
// The temperature channel of whole sessions: it exists only while it is watched, does not depend on
// when watching began, and has no effect on the state.
#include <malloc.h>

#include "core/session/busy_scene.h"

#include "session/session_internal.h"

enum { TICKS = 40 };

static cau_session *opened(cau_scene_def **scene)
{
	*scene = busy_scene();
	return stage_open(*scene, 1);
}

static void finish(cau_session *session, cau_scene_def *scene)
{
	cau_session_destroy(session);
	free(scene);
}

// Checks the channel, vertex by vertex, against the grids of all tools. Returns the number of
// vertices that are not at ambient.
static int32_t expect_the_grids(const cau_session *session)
{
	cau_frame frame = stage_frame(session);
	int32_t away = 0;
	assert_non_null(frame.temperature);
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		double hottest = session->scene->ambient_c;
		for (int32_t i = 0; i < session->tool_count; i++)
			hottest = fmax(hottest, cau_heat_grid_at(&session->tool[i].grid,
			                                         cau_vec3_of(frame.position + 3 * (size_t)v)));
		assert_true(frame.temperature[v] == (float)hottest);
		away += frame.temperature[v] > (float)session->scene->ambient_c;
	}
	return away;
}

static void test_it_is_there_when_asked_for(void **state)
{
	(void)state;
	cau_scene_def *scene;
	cau_session *session = opened(&scene);
	busy_run(session, TICKS);
	assert_null(stage_frame(session).temperature);
	// The channel exists at once, without a step.
	cau_session_watch(session, CAU_CHANNEL_TEMPERATURE);
	assert_true(expect_the_grids(session) > 20);
	for (int tick = 0; tick < 10; tick++) {
		busy_run(session, 1);
		assert_true(expect_the_grids(session) > 20);
	}
	cau_session_watch(session, 0);
	assert_null(stage_frame(session).temperature);
	finish(session, scene);
}

static void test_the_state_does_not_know_of_it(void **state)
{
	(void)state;
	cau_scene_def *scene[2];
	cau_session *plain = opened(&scene[0]), *shown = opened(&scene[1]);
	cau_session_watch(shown, CAU_CHANNEL_TEMPERATURE);
	assert_int_equal(expect_the_grids(shown), 0);
	for (int tick = 0; tick < TICKS; tick++) {
		busy_run(plain, 1);
		busy_run(shown, 1);
		assert_true(cau_session_hash(plain) == cau_session_hash(shown));
	}
	assert_true(expect_the_grids(shown) > 20);
	finish(plain, scene[0]);
	finish(shown, scene[1]);
}

static void test_a_restored_session_shows_its_own(void **state)
{
	(void)state;
	cau_scene_def *scene;
	cau_session *session = opened(&scene);
	cau_session_watch(session, CAU_CHANNEL_TEMPERATURE);
	stage_bytes cold = stage_snapshot(session);
	busy_run(session, TICKS);
	stage_bytes hot = stage_snapshot(session);
	assert_true(expect_the_grids(session) > 20);
	assert_int_equal(cau_session_restore(session, cold.bytes, cold.count, NULL, NULL), CAU_OK);
	assert_int_equal(expect_the_grids(session), 0);
	assert_int_equal(cau_session_restore(session, hot.bytes, hot.count, NULL, NULL), CAU_OK);
	assert_true(expect_the_grids(session) > 20);
	free(cold.bytes);
	free(hot.bytes);
	finish(session, scene);
}

// Steps of a tool that heats and cuts nothing allocate no memory for the channel.
static void test_a_step_allocates_nothing_for_it(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	stage_add_sheet(scene, "fascia", 0.06, 0.03, 24, 12);
	stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0, 0, 0.005);
	cau_session *session = stage_open(scene, 1);
	stage_energize(session, "ball", 1);
	cau_session_watch(session, CAU_CHANNEL_TEMPERATURE);
	stage_step(session, 10);
	struct mallinfo2 before = mallinfo2();
	stage_step(session, 10);
	struct mallinfo2 after = mallinfo2();
	assert_true(after.uordblks == before.uordblks && after.hblkhd == before.hblkhd);
	assert_true(expect_the_grids(session) > 20);
	finish(session, scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_it_is_there_when_asked_for),
		cmocka_unit_test(test_the_state_does_not_know_of_it),
		cmocka_unit_test(test_a_restored_session_shows_its_own),
		cmocka_unit_test(test_a_step_allocates_nothing_for_it),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

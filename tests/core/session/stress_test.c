// SPDX-License-Identifier: GPL-3.0-or-later
// The stress channel of whole sessions: the channel exists only while a client watches it, even
// before a step, and a restored session has its own stress.
#include "core/session/stage.h"

enum { TICKS = 20 };

static cau_scene_def *hanging_block(void)
{
	const double size[3] = {0.03, 0.02, 0.01}, least[3] = {-1, -1, -0.0001}, most[3] = {1, 1, 1};
	const int32_t cells[3] = {6, 4, 2};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	stage_add_slab(scene, "fat", size, cells);
	stage_pin_box(scene, least, most);
	cau_default_gravity(scene->gravity_m_s2);
	return scene;
}

static double largest(const cau_session *session)
{
	cau_frame frame = stage_frame(session);
	int32_t count = stage_info(session).vertex_count;
	double most = 0;
	assert_non_null(frame.stress);
	for (int32_t v = 0; v < count; v++)
		most = fmax(most, (double)frame.stress[v]);
	return most;
}

static void it_is_there_at_once(void **state)
{
	(void)state;
	cau_scene_def *scene = hanging_block();
	cau_session *always = stage_open(scene, 1), *asked = stage_open(scene, 1);
	cau_session_watch(always, CAU_CHANNEL_STRESS);
	stage_step(always, TICKS);
	stage_step(asked, TICKS);
	assert_null(stage_frame(asked).stress);
	cau_session_watch(asked, CAU_CHANNEL_STRESS);
	assert_true(largest(always) > 0);
	assert_memory_equal(stage_frame(asked).stress, stage_frame(always).stress,
	                    (size_t)stage_info(asked).vertex_count * sizeof(float));
	cau_session_watch(asked, 0);
	assert_null(stage_frame(asked).stress);
	cau_session_destroy(always);
	cau_session_destroy(asked);
	free(scene);
}

static void a_restored_session_shows_its_own(void **state)
{
	(void)state;
	cau_scene_def *scene = hanging_block();
	cau_session *session = stage_open(scene, 1);
	cau_session_watch(session, CAU_CHANNEL_STRESS);
	double before = largest(session);
	stage_bytes start = stage_snapshot(session);
	stage_force(session, stage_everything(), 0, 0, -0.01);
	stage_step(session, TICKS);
	assert_true(largest(session) > 2 * before);
	assert_int_equal(cau_session_restore(session, start.bytes, start.count, NULL, NULL), CAU_OK);
	assert_true(largest(session) == before);
	free(start.bytes);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_is_there_at_once),
		cmocka_unit_test(a_restored_session_shows_its_own),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

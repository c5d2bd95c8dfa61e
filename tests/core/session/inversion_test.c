// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedra that stay inverted are counted by layer, after half a second and not earlier, until
// they recover. The gain of energy is reported with a reference, energy_scale_j.
#include "core/session/stage.h"
#include "session/session_internal.h"

enum { LONG_TICKS = 30 };

// Returns a scene with a force in the middle of a slab that StVK's law cannot resist. A second
// layer at the same place keeps its shape.
static cau_scene_def *squashed_scene(int precision)
{
	const double size[3] = {0.04, 0.04, 0.01}, floor_m[2][3] = {{-1, -1, -0.0101}, {1, 1, -0.0099}};
	const int32_t cells[3] = {8, 8, 2};
	cau_scene_def *scene = stage_scene(precision);
	stage_add_slab(scene, "firm", size, cells);
	cau_layer_def *soft = stage_add_slab(scene, "soft", size, cells);
	soft->fat->model = CAU_MODEL_STVK;
	soft->fat->young_modulus_pa = 3000;
	stage_pin_box(scene, floor_m[0], floor_m[1]);
	return scene;
}

static int32_t total(const cau_statistics *statistics)
{
	int32_t sum = 0;
	for (int i = 0; i < CAU_MAX_LAYERS; i++)
		sum += statistics->long_inverted[i];
	return sum;
}

static void press(cau_session *session, double force_n)
{
	const double least[3] = {-0.011, -0.011, -0.0005}, most[3] = {0.011, 0.011, 0.0005};
	cau_selection middle = stage_box(least, most);
	strcpy(middle.layer, "soft");
	stage_force(session, middle, 0, 0, -force_n);
}

static void what_stays_is_counted_by_layer(void **state)
{
	(void)state;
	cau_scene_def *scene = squashed_scene(CAU_PRECISION_DOUBLE);
	cau_session *session = stage_open(scene, 1);
	int first = 0, counted = 0;
	press(session, 0.02);
	for (int tick = 1; tick <= 100; tick++) {
		stage_step(session, 1);
		cau_statistics now = stage_frame(session).statistics;
		first = !first && now.inverted ? tick : first;
		counted = !counted && total(&now) ? tick : counted;
		assert_true(total(&now) <= now.inverted);
		assert_int_equal(now.long_inverted[0], 0);
		if (counted)
			assert_true(now.long_inverted[1] > 0);
	}
	print_message("first inverted in tick %d, counted in tick %d\n", first, counted);
	assert_true(first > 0 && counted >= first + LONG_TICKS - 1);
	assert_int_equal(session->inversion.long_ticks, LONG_TICKS);
	cau_session_destroy(session);
	free(scene);
}

// Inverts tetrahedra by hand: a corner of the firm slab is held on their other side.
static void what_comes_right_is_counted_no_more(void **state)
{
	(void)state;
	cau_scene_def *scene = squashed_scene(CAU_PRECISION_DOUBLE);
	cau_session *session = stage_open(scene, 1);
	cau_inversion *inversion = &session->inversion;
	int32_t corner = session->tissue.primitives.tetrahedron[0];
	double kept[3], *at = session->vertices.position + 3 * (size_t)corner;
	stage_step(session, 1);
	memcpy(kept, at, sizeof kept);
	for (int c = 0; c < 3; c++) // reflects the corner at the middle of the slab
		at[c] = 2 * (c == 2 ? -0.005 : 0) - at[c];
	for (int tick = 1; tick <= LONG_TICKS + 5; tick++) {
		inversion->count = 1;
		cau_session_follow_inversion(session);
		assert_int_equal(inversion->long_count[0] > 0, tick >= LONG_TICKS);
		assert_int_equal(inversion->long_count[1], 0);
	}
	memcpy(at, kept, sizeof kept);
	cau_session_follow_inversion(session);
	assert_int_equal(inversion->long_count[0], 0);
	inversion->count = 0;
	cau_session_follow_inversion(session);
	assert_false(inversion->followed);
	cau_session_destroy(session);
	free(scene);
}

// A falling slab: the energy scale of a step is its kinetic energy and the work of gravity.
static void a_gain_has_its_scale(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	const double size[3] = {0.04, 0.04, 0.01};
	const int32_t cells[3] = {8, 8, 2};
	stage_add_slab(scene, "fat", size, cells)->fat->model = CAU_MODEL_NEOHOOKEAN;
	scene->damping_per_s = 0;
	scene->gravity_m_s2[2] = -9.81;
	cau_session *session = stage_open(scene, 1);
	for (int tick = 0; tick < 30; tick++) {
		cau_balance before = stage_balance(session);
		stage_step(session, 1);
		cau_balance after = stage_balance(session);
		double fallen_j = before.gravitational_j - after.gravitational_j;
		double expected_j = before.kinetic_j + before.elastic_j + fabs(fallen_j);
		double scale_j = stage_frame(session).statistics.energy_scale_j;
		assert_true(fabs(scale_j - expected_j) < 1e-6 * expected_j + 1e-15);
	}
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_stays_is_counted_by_layer),
		cmocka_unit_test(what_comes_right_is_counted_no_more),
		cmocka_unit_test(a_gain_has_its_scale),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

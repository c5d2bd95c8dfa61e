// SPDX-License-Identifier: GPL-3.0-or-later
// The energy gain of a step. The gain is 0 at rest, and in converged steps, for any kind of work on
// the tissue. The gain is not 0 if ten iterations leave a hanging sheet far from its step's
// solution.
#include "core/session/stage.h"

#include <stdio.h>

enum { FEW = 10, CONVERGED = 1000 };

// Largest error of an energy: rounding in double, relative to the largest energy.
static const double ROUNDING = 1e-9;

typedef struct tally {
	double most_j, gained_j, sum_j; // largest gain of a tick; sum of all gains; gains less losses
} tally;

static void run(cau_session *session, int ticks, tally *t)
{
	for (int k = 0; k < ticks; k++) {
		stage_step(session, 1);
		double gain_j = stage_frame(session).statistics.energy_gain_j;
		assert_true(isfinite(gain_j));
		t->most_j = fmax(t->most_j, gain_j);
		t->gained_j += fmax(gain_j, 0);
		t->sum_j += gain_j;
	}
}

// Returns a scene: a block of fat on a pinned floor.
static cau_scene_def *make_block(void)
{
	const double size[3] = {0.04, 0.03, 0.02};
	const int32_t cells[3] = {5, 4, 3};
	const double least[3] = {-1, -1, -0.0201}, most[3] = {1, 1, -0.0199};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	stage_add_slab(scene, "fat", size, cells);
	stage_pin_box(scene, least, most);
	scene->iterations = CONVERGED;
	scene->tolerance = 1e-9;
	return scene;
}

static void rest_reads_nothing(void **state)
{
	(void)state;
	for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++) {
		tally t = {0};
		cau_scene_def *scene = make_block();
		scene->precision = precision;
		scene->iterations = FEW;
		cau_session *session = stage_open(scene, 1);
		run(session, 30, &t);
		assert_true(t.gained_j == 0 && t.sum_j == 0);
		cau_session_destroy(session);
		free(scene);
	}
}

// A level sheet of 6 cm, pinned along an edge, begins to fall.
static double hang(int iterations)
{
	const double least[3] = {-1, 0.0299, -1}, most[3] = {1, 1, 1};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	stage_add_sheet(scene, "sheet", 0.06, 0.06, 20, 20);
	cau_default_gravity(scene->gravity_m_s2);
	scene->iterations = iterations;
	scene->tolerance = 1e-7;
	scene->damping_per_s = 2;
	stage_pin_box(scene, least, most);
	cau_session *session = stage_open(scene, 2);
	tally t = {0};
	run(session, 50, &t);
	print_message("K = %d: %.3g J gained, %.3g J at most in a tick, %.3g J in all\n", iterations,
	              t.gained_j, t.most_j, t.sum_j);
	cau_session_destroy(session);
	free(scene);
	return t.gained_j;
}

// The sheet weighs 20 mN, so a fall of a centimetre gives 0.2 mJ. Few iterations are enough,
// because Newton's method solves the loose sheet in each of them.
static void a_hanging_sheet_gains_nothing(void **state)
{
	(void)state;
	double fall_j = 2e-4;
	assert_true(hang(FEW) < ROUNDING * fall_j);
	assert_true(hang(CONVERGED) < ROUNDING * fall_j);
}

// ---- work: the block is stretched slowly. Its energy must equal the work done on it. Implicit
// Euler applies the force at a step's end during the whole step. So of the work of n steps a share
// of 1 / n is lost, and no step gains energy.
enum { PULL_TICKS = 40 };
static const double LOSS_MOST = 0.1; // largest share of lost work: twice 2 / PULL_TICKS

static void assert_brought_in(cau_session *session, const tally *t, const char *by)
{
	cau_balance balance = stage_balance(session);
	double held_j = balance.elastic_j + balance.kinetic_j;
	print_message("%s: holds %.4g J, gained %.3g J, lost %.3g J\n", by, held_j, t->gained_j,
	              t->gained_j - t->sum_j);
	assert_true(held_j > 1e-7);
	assert_true(t->gained_j <= ROUNDING * held_j);
	assert_true(t->gained_j - t->sum_j < LOSS_MOST * held_j);
}

static void a_led_support_brings_in_what_is_held(void **state)
{
	(void)state;
	const double least[3] = {-1, -1, -1e-6}, most[3] = {1, 1, 1};
	cau_scene_def *scene = make_block();
	stage_pin_box(scene, least, most);
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	int32_t *top = malloc((size_t)info.vertex_count * sizeof *top), count = 0;
	double *at = malloc(3 * (size_t)info.vertex_count * sizeof *at);
	for (int32_t v = 0; v < info.vertex_count; v++)
		if (info.rest_position[3 * v + 2] > -1e-6)
			top[count++] = v;
	tally t = {0};
	cau_error error = {0};
	for (int tick = 1; tick <= PULL_TICKS; tick++) {
		for (int32_t k = 0; k < count; k++)
			for (int c = 0; c < 3; c++)
				at[3 * k + c] = info.rest_position[3 * top[k] + c] + (c == 2 ? 5e-5 * tick : 0);
		assert_int_equal(cau_session_drive(session, count, top, at, &error), CAU_OK);
		run(session, 1, &t);
	}
	assert_brought_in(session, &t, "support");
	free(top);
	free(at);
	cau_session_destroy(session);
	free(scene);
}

// Work by grasping jaws, and by forces.
static void tools_and_forces_bring_in_what_is_held(void **state)
{
	(void)state;
	const double least[3] = {-1, -1, -1e-6}, most[3] = {1, 1, 1};
	for (int by_force = 0; by_force < 2; by_force++) {
		cau_scene_def *scene = make_block();
		stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.004, 0, by_force ? 0.1 : -0.004);
		cau_session *session = stage_open(scene, 1);
		tally t = {0};
		if (!by_force)
			stage_grasp(session, "jaws");
		run(session, 1, &t);
		for (int tick = 1; tick <= PULL_TICKS; tick++) {
			if (by_force)
				stage_force(session, stage_box(least, most), 0, 0, 2e-5 * tick);
			else
				stage_move(session, "jaws", 0.004, 0, -0.004 + 5e-5 * tick);
			run(session, 1, &t);
		}
		assert_brought_in(session, &t, by_force ? "forces" : "jaws");
		cau_session_destroy(session);
		free(scene);
	}
}

// A restored session continues with the same energies.
static void a_snapshot_changes_nothing(void **state)
{
	(void)state;
	cau_scene_def *scene = make_block();
	scene->gravity_m_s2[2] = -9.81;
	scene->iterations = FEW;
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 1);
	stage_step(session, 10);
	stage_bytes shot = stage_snapshot(session);
	cau_error error = {0};
	bool exact;
	assert_int_equal(cau_session_restore(other, shot.bytes, shot.count, &exact, &error), CAU_OK);
	for (int tick = 0; tick < 5; tick++) {
		stage_step(session, 1);
		stage_step(other, 1);
		double a = stage_frame(session).statistics.energy_gain_j;
		double b = stage_frame(other).statistics.energy_gain_j;
		assert_true(fabs(a - b) <= ROUNDING * stage_balance(session).elastic_j);
		assert_true(cau_session_hash(session) == cau_session_hash(other));
	}
	free(shot.bytes);
	cau_session_destroy(other);
	cau_session_destroy(session);
	free(scene);
}

// A layered body is cut and shrinks. The energy that heat adds by shrinking is not a gain.
static void what_shrinks_does_not_count(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	scene->precision = CAU_PRECISION_DOUBLE;
	scene->iterations = 300;
	scene->tolerance = 1e-7;
	scene->layers[0].sheet[0].heat.absorption_per_s = 20; // the layer parts soon
	scene->layers[0].sheet[0].shrink[0] = 0.1;
	scene->layers[0].sheet[0].shrink[1] = 0.3;
	scene->tools[0].temperature_c = 600;
	cau_session *session = stage_open(scene, 2);
	tally t = {0};
	stage_energize(session, "hook", 1);
	for (int tick = 0; tick < 60; tick++) {
		stage_move(session, "hook", -0.01 + 3e-4 * tick, 0, 0.002);
		run(session, 1, &t);
	}
	cau_balance balance = stage_balance(session);
	int32_t removed = stage_frame(session).statistics.elements_removed;
	print_message("%d elements removed: holds %.3g J, gained %.3g J, lost %.3g J\n", removed,
	              balance.elastic_j, t.gained_j, t.gained_j - t.sum_j);
	assert_true(removed > 10);
	// The bound allows for the error that the steps' tolerance leaves.
	assert_true(t.gained_j < 1e-6 * balance.elastic_j);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rest_reads_nothing),
		cmocka_unit_test(a_hanging_sheet_gains_nothing),
		cmocka_unit_test(a_led_support_brings_in_what_is_held),
		cmocka_unit_test(tools_and_forces_bring_in_what_is_held),
		cmocka_unit_test(a_snapshot_changes_nothing),
		cmocka_unit_test(what_shrinks_does_not_count),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// No pull of a grasper breaks a scene: steps stay bounded, and inverted elements recover.
#include "core/session/stage.h"

#include <stdio.h>

// Largest distance of a vertex, m. A pull of 0.1 m on a scene of 0.12 m stays below this distance.
static const double bounded_m = 0.3;
// Number of directions of pulls under sanitizers, where a step takes thirty times as long. The
// other directions use the same code.
static const size_t ways_under_sanitizers = 1;

static double farthest(const cau_session *session, int32_t *inverted)
{
	cau_session_info info = stage_info(session);
	cau_frame frame = stage_frame(session);
	for (int32_t i = 0; i < 3 * info.vertex_count; i++)
		assert_true(isfinite(frame.position[i]));
	*inverted = frame.statistics.inverted > *inverted ? frame.statistics.inverted : *inverted;
	return stage_farthest(&frame, info.rest_position, info.vertex_count);
}

static const double ways[][3] = {{0, 0, 0.1},  {0.1, 0, 0},  {-0.1, 0, 0},      {0, 0.1, 0},
                                 {0, -0.1, 0}, {0, 0, -0.1}, {0.06, 0.06, 0.06}};

// Turns tearing off, so that all pulled tissue remains and can recover.
static void bear_all(cau_scene_def *scene)
{
	for (int32_t i = 0; i < scene->layer_count; i++) {
		cau_layer_def *layer = &scene->layers[i];
		layer->sheet[0].heat.tear_energy_j_m2 = layer->fat[0].heat.tear_energy_j_m2 =
			layer->link.heat.tear_energy_j_m2 = 0;
	}
}

static void pull_every_way(const char *name, double top_m, double slip_force_n)
{
	cau_scene_def *scene = stage_scene_light(name);
	bear_all(scene);
	cau_tool_def *jaws =
		stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.01, 0.005, top_m - 0.004);
	jaws->max_speed_m_s = 5; // the largest speed that a scene may have
	jaws->slip_force_n = slip_force_n;
	jaws->force_max_n = 1000; // with a large force the jaws do not stay behind
	jaws->grasp_stiffness_n_m = slip_force_n > 100 ? 1e4 : 200;
	cau_session *session = stage_open(scene, 2);
	size_t way_count = CAU_TEST_SANITIZED ? ways_under_sanitizers : sizeof ways / sizeof *ways;
	for (size_t w = 0; w < way_count; w++) {
		const double *at = jaws->pose.position_m;
		int32_t inverted = 0, held;
		stage_move(session, "jaws", at[0], at[1], at[2]);
		stage_step(session, 20);
		stage_grasp(session, "jaws");
		stage_step(session, 1);
		held = stage_tool(session, "jaws")->grasped_vertices;
		assert_true(held > 0);
		stage_move(session, "jaws", at[0] + ways[w][0], at[1] + ways[w][1], at[2] + ways[w][2]);
		double far = 0;
		for (int tick = 0; tick < 20; tick++) {
			stage_step(session, 1);
			far = fmax(far, farthest(session, &inverted));
		}
		stage_release(session, "jaws");
		stage_move(session, "jaws", at[0], at[1], 0.2);
		stage_step(session, 30);
		int32_t left = 0;
		farthest(session, &left);
		print_message("%s, way %zu: %d held, %.3f m, %d inverted, %d after\n", name, w, held, far,
		              inverted, left);
		assert_true(far < bounded_m);
		assert_true(left <= inverted / 10); // most have recovered
	}
	stage_step(session, 60);
	assert_int_equal(stage_frame(session).statistics.inverted, 0);
	cau_session_destroy(session);
	free(scene);
}

// ---- tissue that tears

// Jaws that never slip are moved away at once, and moved back to grasp the rest. Tissue that cannot
// follow tears, or is torn out of the jaws. Without tearing, tissue diverged until a step had no
// solution (in one to three of 21 positions and stiffnesses, depending on the build).
static void tear_away(double x, double y, double stiffness_n_m, size_t way_count)
{
	cau_scene_def *scene = stage_scene_light("layers");
	cau_tool_def *jaws = stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, x, y, -0.002);
	jaws->max_speed_m_s = 5;
	jaws->slip_force_n = jaws->force_max_n = 1000;
	jaws->grasp_stiffness_n_m = stiffness_n_m;
	cau_session *session = stage_open(scene, 2);
	double far = 0;
	int32_t inverted = 0;
	for (size_t w = 0; w < way_count; w++) {
		stage_move(session, "jaws", x, y, -0.002);
		stage_step(session, 20);
		stage_grasp(session, "jaws");
		stage_step(session, 1);
		stage_move(session, "jaws", x + ways[w][0], y + ways[w][1], -0.002 + ways[w][2]);
		for (int tick = 0; tick < 20; tick++) {
			stage_step(session, 1);
			far = fmax(far, farthest(session, &inverted));
		}
		stage_release(session, "jaws");
		stage_move(session, "jaws", x, y, 0.2);
		stage_step(session, 30);
	}
	int32_t torn = stage_frame(session).statistics.elements_torn;
	print_message("layers at (%.0f, %.0f) mm, %.0f N/m: %d torn, %.3f m, %d inverted\n", 1000 * x,
	              1000 * y, stiffness_n_m, torn, far, inverted);
	assert_true(torn > 0 && far < bounded_m);
	cau_session_destroy(session);
	free(scene);
}

static const double places[][2] = {{0.01, 0.005}, {0, 0},         {-0.02, 0.01}, {0.03, -0.015},
                                   {0.02, 0.02},  {-0.01, -0.02}, {0.005, 0.012}};

static void layers_that_tear_survive_a_pull(void **state)
{
	(void)state;
	tear_away(places[0][0], places[0][1], 1e4, CAU_TEST_SANITIZED ? 1 : 2);
}

static void layers_that_tear_survive_any_pull(void **state)
{
	(void)state;
	for (size_t p = 0; p < sizeof places / sizeof *places; p++)
		for (double stiffness_n_m = 1e3; stiffness_n_m < 2e5; stiffness_n_m *= 10)
			tear_away(places[p][0], places[p][1], stiffness_n_m, sizeof ways / sizeof *ways);
}

static void fat_survives_any_pull(void **state)
{
	(void)state;
	pull_every_way("fat-neohookean", 0, 2);
	pull_every_way("fat-neohookean", 0, 1000); // jaws that never slip
}

static void layers_survive_any_pull(void **state)
{
	(void)state;
	pull_every_way("layers", 0.002, 1000);
}

int main(int count, char **argument)
{
	const struct CMUnitTest long_tests[] = {cmocka_unit_test(layers_that_tear_survive_any_pull)};
	if (count > 1 && !strcmp(argument[1], "--long"))
		return cmocka_run_group_tests(long_tests, NULL, NULL);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(fat_survives_any_pull),
		cmocka_unit_test(layers_survive_any_pull),
		cmocka_unit_test(layers_that_tear_survive_a_pull),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

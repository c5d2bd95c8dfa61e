// SPDX-License-Identifier: GPL-3.0-or-later
// Contact between tissue and tissue in whole sessions. Tissue that is pushed, laid or folded
// together touches and never crosses, whatever tools do. The bits are the same in every run.
#include <stdio.h>

#include "core/session/surface_crossing.h"
#include "session/session_internal.h"

enum { LOOK = 10, TOOL_TICKS = CAU_TEST_SANITIZED ? 60 : 300, TOOL_MOTIONS = 10000 };

static const double THICKNESS_M = 5e-4;
// Largest energy gain of a tick, J. Ten iterations leave an error, which can add energy. For
// comparison: a falling sheet of these tests has about 1e-5 J.
static const double GAIN_J = 1e-5;

typedef struct course {
	double most_gain_j, error;
	int most_touching;
} course;

// Steps the session, and checks every LOOK ticks whether anything crosses.
static course run(cau_session *session, int ticks)
{
	course c = {0};
	for (int k = 1; k <= ticks; k++) {
		stage_step(session, 1);
		cau_statistics statistics = stage_frame(session).statistics;
		c.most_gain_j = fmax(c.most_gain_j, statistics.energy_gain_j);
		c.error = statistics.error;
		if (session->collide.result.touching_count > c.most_touching)
			c.most_touching = session->collide.result.touching_count;
		if (k % LOOK == 0)
			assert_int_equal(surface_crossings(session), 0);
	}
	return c;
}

static cau_scene_def *touching_scene(void)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_default_gravity(scene->gravity_m_s2);
	scene->contact_thickness_m = THICKNESS_M;
	return scene;
}

// Returns a scene: a sheet above a slab that is pinned at its floor.
static cau_scene_def *make_flap(void)
{
	const double size[3] = {0.05, 0.04, 0.008};
	const int32_t cells[3] = {16, 12, 2};
	cau_scene_def *scene = touching_scene();
	cau_layer_def *sheet = stage_add_sheet(scene, "fascia", 0.03, 0.02, 12, 8);
	stage_mesh_of(scene, sheet)->translate_m[2] = 0.004;
	stage_add_slab(scene, "fat", size, cells);
	stage_add_membrane(scene, "membrane", "fat");
	stage_pin_box(scene, (double[]){-1, -1, -0.0081}, (double[]){1, 1, -0.0079});
	return scene;
}

static double lowest_of_sheet_m(const cau_session *session)
{
	const cau_tissue_layer *sheet = &session->tissue.layer[0];
	double least = INFINITY;
	for (int32_t v = sheet->first_vertex; v < sheet->first_vertex + sheet->vertex_count; v++)
		least = fmin(least, session->vertices.position[3 * (size_t)v + 2]);
	return least;
}

static void a_flap_that_is_laid_back_stays(void **state)
{
	(void)state;
	cau_scene_def *scene = make_flap();
	cau_session *session = stage_open(scene, 1);
	course fall = run(session, 40);
	assert_true(fall.most_touching > 100 && fall.most_gain_j < GAIN_J);
	double lowest = lowest_of_sheet_m(session);
	// The sheet lies on the slab, whose top is at 0 or sags a little.
	assert_true(lowest > -0.001 && lowest < 0.003);
	stage_force(session,
	            stage_box((double[]){-0.016, -0.011, 0.003}, (double[]){0.016, 0.011, 0.005}), 0, 0,
	            -2e-4); // presses the sheet with ten times its weight
	course pressed = run(session, 30);
	assert_true(pressed.most_gain_j < GAIN_J);
	cau_session_destroy(session);
	scene->contact_thickness_m = 0; // without contact the sheet falls through the slab
	session = stage_open(scene, 1);
	stage_step(session, 60);
	assert_true(lowest_of_sheet_m(session) < -0.02);
	cau_session_destroy(session);
	free(scene);
}

// Pushes two blocks, which are side by side, together at their tops.
static int push_lips(double thickness_m, int integrator)
{
	cau_scene_def *scene = touching_scene();
	scene->integrator = integrator;
	scene->contact_thickness_m = thickness_m;
	const double size[3] = {0.02, 0.03, 0.01};
	const int32_t cells[3] = {8, 12, 4};
	for (int side = -1; side <= 1; side += 2) {
		cau_layer_def *fat = stage_add_slab(scene, side > 0 ? "right" : "left", size, cells);
		stage_mesh_of(scene, fat)->translate_m[0] = 0.011 * side;
		// No cell is opposite an equal cell.
		stage_mesh_of(scene, fat)->translate_m[1] = 0.0003 * side;
	}
	stage_pin_box(scene, (double[]){-1, -1, -0.0101}, (double[]){1, 1, -0.0099});
	cau_session *session = stage_open(scene, 1);
	for (int side = -1; side <= 1; side += 2)
		stage_force(session,
		            stage_box((double[]){side < 0 ? -0.0225 : 0.0005, -1, -0.001},
		                      (double[]){side < 0 ? -0.0005 : 0.0225, 1, 1}),
		            -0.002 * side, 0, 0);
	int crossed = 0;
	if (thickness_m > 0) {
		course c = run(session, 60);
		assert_true(c.most_touching > 100 && c.most_gain_j < GAIN_J);
	} else {
		stage_step(session, 60);
		crossed = surface_crossings(session);
	}
	cau_session_destroy(session);
	free(scene);
	return crossed;
}

static void lips_that_are_pushed_together_never_cross(void **state)
{
	(void)state;
	push_lips(THICKNESS_M, CAU_INTEGRATOR_EULER);
	push_lips(THICKNESS_M, CAU_INTEGRATOR_SDIRK2);
	// Without contact the blocks cross, and the test detects it.
	assert_true(push_lips(0, CAU_INTEGRATOR_EULER) > 0);
}

static void a_hanging_sheet_folds_and_never_crosses(void **state)
{
	(void)state;
	cau_scene_def *scene = touching_scene();
	stage_add_sheet(scene, "fascia", 0.04, 0.02, 20, 10);
	stage_pin_box(scene, (double[]){-1, -1, -1}, (double[]){0.0001, 1, 1});
	cau_session *session = stage_open(scene, 1);
	run(session, 40); // one half hangs, and is pressed to the other half from below
	stage_force(session, stage_box((double[]){0.001, -1, -1}, (double[]){0.0205, 1, 1}), -2e-3, 0,
	            2e-3);
	assert_true(run(session, 60).most_touching > 100);
	cau_session_destroy(session);
	free(scene);
}

static cau_scene_def *make_busy(void)
{
	cau_scene_def *scene = stage_layered();
	scene->contact_thickness_m = THICKNESS_M;
	// The fascia parts soon, even under a fast hook.
	for (int32_t i = 0; i < scene->layer_count; i++)
		if (scene->layers[i].kind == CAU_LAYER_FASCIA)
			scene->layers[i].sheet[0].heat.ignition_c = 8;
	return scene;
}

static double draw(uint64_t *random) // a random number from -1 to 1
{
	*random = *random * 6364136223846793005ull + 1442695040888963407ull;
	return (double)(*random >> 11) / 4503599627370496.0 - 1;
}

// Moves tools to random poses over and in the tissue. One tool is hot; the other may grasp and
// release.
static void wave_tools(cau_session *session, int tick, bool grasping, uint64_t *random)
{
	if (tick % 6 == 0) {
		stage_move(session, "hook", 0.015 * draw(random), 0.01 * draw(random),
		           0.003 + 0.004 * draw(random));
		stage_move(session, "jaws", 0.015 * draw(random), 0.01 * draw(random),
		           0.004 + 0.004 * draw(random));
	}
	if (tick == 10)
		stage_energize(session, "hook", 1);
	if (grasping && tick % 70 == 20)
		stage_grasp(session, "jaws");
	if (grasping && tick % 70 == 60)
		stage_release(session, "jaws");
}

// Runs random tools. Tissue held by jaws may cross other tissue, and still crosses for a time after
// its release. So tissue that was ever held is not checked.
static void run_tools(int ticks, int look, bool grasping)
{
	cau_scene_def *scene = make_busy();
	cau_session *session = stage_open(scene, 2);
	uint8_t *held = calloc((size_t)session->tissue.vertex_count, 1);
	uint64_t random = 11;
	double sum_j = 0;
	for (int tick = 0; tick < ticks; tick++) {
		wave_tools(session, tick, grasping, &random);
		stage_step(session, 1);
		cau_frame frame = stage_frame(session);
		sum_j += frame.statistics.energy_gain_j;
		for (int32_t i = 0; i < 3 * session->tissue.vertex_count; i++)
			assert_true(isfinite(frame.position[i]));
		for (int32_t v = 0; v < session->tissue.vertex_count; v++)
			held[v] |= session->collide.exempt[v];
		if (tick % look == 0)
			assert_int_equal(surface_crossings_but(session, held), 0);
	}
	print_message("%d ticks of tools: %.3g J gained in all, %d elements gone\n", ticks, sum_j,
	              stage_frame(session).statistics.elements_removed);
	assert_true(stage_frame(session).statistics.elements_removed > 0);
	// Friction, plastic flow and implicit steps lose more than unfinished iterations gain.
	assert_true(sum_j < 0);
	cau_session_destroy(session);
	free(scene);
	free(held);
}

static void tools_over_a_cut_scene(void **state)
{
	(void)state;
	run_tools(TOOL_TICKS, LOOK, true);
}

static void many_motions_of_tools(void **state)
{
	(void)state;
	run_tools(6 * TOOL_MOTIONS, 6 * LOOK, false);
}

static void many_motions_of_tools_that_grasp(void **state)
{
	(void)state;
	run_tools(6 * TOOL_MOTIONS, 6 * LOOK, true);
}

// A session restored to the present state reaches the same bits, although it knows nothing else
// about the past.
static void expect_the_same_after_a_restore(cau_session *session)
{
	enum { TICKS = 4 };
	cau_session *other = stage_open(session->scene, 1);
	stage_bytes shot = stage_snapshot(session);
	bool exact = false;
	stage_step(other, 2);
	assert_int_equal(cau_session_restore(other, shot.bytes, shot.count, &exact, NULL), CAU_OK);
	assert_true(exact);
	stage_step(other, TICKS);
	uint64_t hash = cau_session_hash(other);
	cau_session_destroy(other);
	stage_step(session, TICKS);
	assert_true(cau_session_hash(session) == hash);
	free(shot.bytes);
}

// Jaws that never slip pull `layers` at 5 m/s. Tissue cannot be kept apart at that speed, and
// tetrahedra become inverted. Frames report it. After the release no tetrahedron stays inverted,
// and no vertex stays excluded from contact. (A vertex is excluded while it crosses other tissue.)
// The exclusion depends on rounding: with kernels below AVX-512, or without the compiler's
// optimisation, some vertices stay excluded to the end (.github/KNOWN_BUGS.md). On every processor
// no other vertex crosses anything.
static void what_is_thrown_finds_its_way_back(void **state)
{
	(void)state;
	enum { DRAWN = 20, TICKS = 100 };
	// The pull tests something only if more than one tetrahedron in LEAST_INVERTED becomes
	// inverted. These are 100 of the 30,000 in the full `layers`.
	enum { LEAST_INVERTED = 300 };
	cau_scene_def *scene = stage_scene_light("layers");
	scene->contact_thickness_m = THICKNESS_M;
	// With twenty iterations, the scene's number, 130 vertices stay excluded.
	scene->iterations = 10;
	for (int32_t i = 0; i < scene->layer_count; i++) // no tissue tears
		scene->layers[i].sheet[0].heat.tear_energy_j_m2 =
			scene->layers[i].fat[0].heat.tear_energy_j_m2 =
				scene->layers[i].link.heat.tear_energy_j_m2 = 0;
	cau_tool_def *jaws = stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.01, 0.005, -0.002);
	jaws->max_speed_m_s = 5;
	jaws->slip_force_n = jaws->force_max_n = 1000;
	jaws->grasp_stiffness_n_m = 1e4;
	cau_session *session = stage_open(scene, 2);
	int told = 0, most_inverted = 0, exempt = 0;
	stage_step(session, 20);
	stage_grasp(session, "jaws");
	stage_step(session, 1);
	stage_move(session, "jaws", 0.11, 0.005, -0.002);
	for (int tick = 0; tick < TICKS; tick++) {
		if (tick == DRAWN) {
			stage_release(session, "jaws");
			stage_move(session, "jaws", 0.01, 0.005, 0.2);
		}
		stage_step(session, 1);
		told += stage_frame(session).statistics.touching_cut_short;
		most_inverted =
			session->inversion.count > most_inverted ? session->inversion.count : most_inverted;
		if (tick == DRAWN + 5)
			expect_the_same_after_a_restore(session);
	}
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		exempt += session->collide.exempt[v];
	int crossings = surface_crossings(session);
	print_message("told of %d times, %d inside out; at last %d, %d touch nothing, %d crossings\n",
	              told, most_inverted, session->inversion.count, exempt, crossings);
	assert_true(told > 0);
	assert_true(most_inverted > session->tissue.tetrahedron_count / LEAST_INVERTED);
	assert_int_equal(session->inversion.count, 0);
	assert_int_equal(surface_crossings_but(session, session->collide.exempt), 0);
	cau_session_info info;
	cau_session_describe(session, &info);
#ifdef __OPTIMIZE__
	if (!strcmp(info.instruction_set, "avx512"))
		assert_int_equal(exempt, 0);
#endif
	assert_true(exempt == 0 || crossings > 0);
	cau_session_destroy(session);
	free(scene);
}

// If there are more pairs than the capacity, the session reports it, stops the tissue, and nothing
// crosses.
static void want_of_room_is_told(void **state)
{
	(void)state;
	cau_scene_def *scene = make_flap();
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 1);
	assert_int_equal(stage_frame(session).statistics.touching_cut_short, 0);
	session->collide.most_pairs = 40; // far too few once the tissues are near
	int told = 0;
	for (int tick = 0; tick < 30; tick++) {
		stage_step(session, 1);
		told += stage_frame(session).statistics.touching_cut_short;
	}
	assert_true(told > 0);
	assert_int_equal(surface_crossings(session), 0);
	cau_session_destroy(session);
	free(scene);
}

static void the_same_bits(void **state)
{
	(void)state;
	enum { TICKS = 30, SAVED = 15 };
	cau_scene_def *scene = make_flap();
	cau_session *one = stage_open(scene, 1), *three = stage_open(scene, 3);
	cau_session *later = stage_open(scene, 2);
	for (int tick = 0; tick < TICKS; tick++) {
		stage_step(one, 1);
		stage_step(three, 1);
		assert_true(cau_session_hash(one) == cau_session_hash(three));
		if (tick == SAVED) {
			assert_true(one->collide.result.touching_count > 0);
			stage_bytes shot = stage_snapshot(one);
			bool exact = false;
			assert_int_equal(cau_session_restore(later, shot.bytes, shot.count, &exact, NULL),
			                 CAU_OK);
			assert_true(exact);
			free(shot.bytes);
		} else if (tick > SAVED) {
			stage_step(later, 1);
			assert_true(cau_session_hash(one) == cau_session_hash(later));
		}
	}
	cau_session_destroy(one);
	cau_session_destroy(three);
	cau_session_destroy(later);
	free(scene);
}

// Sheets that cross each other from the start neither diverge nor fault.
static void what_begins_crossed_stays_calm(void **state)
{
	(void)state;
	cau_scene_def *scene = touching_scene();
	memset(scene->gravity_m_s2, 0, sizeof scene->gravity_m_s2);
	stage_add_sheet(scene, "fascia", 0.03, 0.02, 15, 10);
	cau_layer_def *other = stage_add_sheet(scene, "other", 0.03, 0.02, 14, 9);
	stage_mesh_of(scene, other)->translate_m[0] = 0.004;
	stage_mesh_of(scene, other)->translate_m[2] = 1e-4;
	cau_session *session = stage_open(scene, 1);
	// Bends one sheet through the other.
	for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++)
		if ((int32_t)v >= session->tissue.layer[1].first_vertex)
			session->vertices.position[3 * v + 2] += 0.1 * session->vertices.position[3 * v];
	assert_true(surface_crossings(session) > 0);
	for (int tick = 0; tick < 60; tick++) {
		stage_step(session, 1);
		cau_frame frame = stage_frame(session);
		assert_true(frame.statistics.energy_gain_j < GAIN_J);
		for (int32_t v = 0; v < session->tissue.vertex_count; v++)
			assert_true(cau_length(cau_vec3_of(frame.velocity + 3 * (size_t)v)) < 1);
	}
	cau_session_destroy(session);
	free(scene);
}

int main(int count, char **argument)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_flap_that_is_laid_back_stays),
		cmocka_unit_test(lips_that_are_pushed_together_never_cross),
		cmocka_unit_test(a_hanging_sheet_folds_and_never_crosses),
		cmocka_unit_test(tools_over_a_cut_scene),
		cmocka_unit_test(what_is_thrown_finds_its_way_back),
		cmocka_unit_test(want_of_room_is_told),
		cmocka_unit_test(the_same_bits),
		cmocka_unit_test(what_begins_crossed_stays_calm),
	};
	const struct CMUnitTest long_tests[] = {
		cmocka_unit_test(many_motions_of_tools),
		cmocka_unit_test(many_motions_of_tools_that_grasp),
	};
// ThreadSanitizer runs only the test with the most threads; the others run the same parallel loops.
#ifdef __SANITIZE_THREAD__
	const struct CMUnitTest threaded[] = {cmocka_unit_test(the_same_bits)};
	return cmocka_run_group_tests(threaded, NULL, NULL);
#endif
	if (count > 1 && !strcmp(argument[1], "--long"))
		return cmocka_run_group_tests(long_tests, NULL, NULL);
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The volume that a cut removes does not depend on the mesh, if elements part one by one. Whole
// sessions cut a slab of `fat-neohookean` with its membrane, which the tool presses in, drags and
// burns, for 40 mm at the scene's speed. The result is the mean of eight cuts at different
// positions in the cells. Compared with the shipped cells it must agree within 15 % for 1 to 2
// times as many cells along an edge, and within 30 % for half as many cells.
//
// The slab is as wide as the tool's effect, and steps are 1/30 s long, which removes the same
// volume (tests/paper/validation.md). Without options: the shipped cells and half of them. With
// `--long`: finer cells.
#include <stdio.h>

#include "core/session/stage.h"
#include "session/session_internal.h"

// Number of cuts whose mean is taken. Under sanitizers one cut suffices, because steps take long
// and all cuts run the same code.
enum { WAYS = CAU_TEST_SANITIZED ? 1 : 8 };
static const double half_cut_m = 0.02, cell_m = 0.002, near_m = 1e-4;

// Numbers of cells of 2 mm in the shipped scene. The ball's radius is 3 mm.
static const int32_t shipped_cells[3] = {26, 10, 4};
static const double step_s = 1.0 / 30;

// Pins the bottom and both short ends, as in the shipped slab.
static void pin(cau_scene_def *scene, const double size_m[3])
{
	const double end = size_m[0] / 2 - near_m;
	scene->pin_count = 0;
	stage_pin_box(scene, (double[]){-1, -1, -1}, (double[]){1, 1, near_m - size_m[2]});
	stage_pin_box(scene, (double[]){-1, -1, -1}, (double[]){-end, 1, 1});
	stage_pin_box(scene, (double[]){end, -1, -1}, (double[]){1, 1, 1});
}

// Returns the scene of cut number `way`. Its position within a cell follows the golden ratio, so
// that no two cuts have the same position.
static cau_scene_def *scene_of(double fineness, int parting, int way)
{
	cau_scene_def *scene = stage_scene_named("fat-neohookean");
	cau_mesh_def *mesh = &scene->meshes[0];
	for (int c = 0; c < 3; c++) {
		mesh->size_m[c] = shipped_cells[c] * cell_m;
		mesh->cells[c] = (int32_t)lround(shipped_cells[c] * fineness);
	}
	pin(scene, mesh->size_m);
	scene->parting = parting;
	scene->step_s = step_s;
	double x = cell_m / fineness * way / WAYS, y = cell_m / fineness * fmod(0.618034 * way, 1);
	memcpy(scene->cut.from_m, (double[]){x - half_cut_m, y, 0}, sizeof scene->cut.from_m);
	memcpy(scene->cut.to_m, (double[]){x + half_cut_m, y, 0}, sizeof scene->cut.to_m);
	memcpy(scene->tools[0].pose.position_m, (double[]){x - half_cut_m, y, 0.02},
	       sizeof scene->tools[0].pose.position_m);
	return scene;
}

// Returns the rest volume of the tetrahedra that the scene's cut removes.
static double volume_taken_m3(const cau_scene_def *scene)
{
	cau_session *session = stage_open(scene, 1);
	int ticks = stage_cut_ticks(&scene->cut, scene->step_s);
	for (int tick = 0; tick < ticks; tick++) {
		stage_cut_tick(session, &scene->cut, &scene->tools[0].pose, tick);
		stage_step(session, 1);
	}
	double taken = 0;
	for (int32_t t = 0; t < session->tissue.tetrahedron_count; t++)
		if (!session->dissection.alive.element[CAU_ELEMENT_TETRAHEDRON][t])
			taken += session->tissue.tetrahedron_volume[t];
	cau_session_destroy(session);
	return taken;
}

static double mean_volume_m3(double fineness, int parting)
{
	double sum = 0, least = INFINITY, most = 0;
	for (int way = 0; way < WAYS; way++) {
		cau_scene_def *scene = scene_of(fineness, parting, way);
		double taken = volume_taken_m3(scene);
		sum += taken;
		least = fmin(least, taken);
		most = fmax(most, taken);
		free(scene);
	}
	print_message("%.1f times the cells, by %s: %.0f mm^3 (%.0f to %.0f)\n", fineness,
	              parting == CAU_PARTING_ELEMENTS ? "elements" : "edges", 1e9 * sum / WAYS,
	              1e9 * least, 1e9 * most);
	fflush(stdout);
	return sum / WAYS;
}

static void assert_alike(double volume_m3, double shipped_m3, double fineness)
{
	double off = volume_m3 / shipped_m3 - 1, most = fineness < 1 ? 0.3 : 0.15;
	if (!(fabs(off) <= most))
		fail_msg("%g times the cells: %+.0f %%, more than %.0f %%", fineness, 100 * off,
		         100 * most);
}

// The paper's rule also removes half a cell all round. The test would detect such a difference.
static void half_the_cells_take_as_much(void **state)
{
	(void)state;
	double half = mean_volume_m3(0.5, CAU_PARTING_ELEMENTS);
	assert_true(half > 1e-7);
	assert_true(mean_volume_m3(0.5, CAU_PARTING_EDGES) > 2 * half);
	if (CAU_TEST_SANITIZED)
		return; // one cut's volume says nothing about the mesh
	double shipped = mean_volume_m3(1, CAU_PARTING_ELEMENTS);
	assert_alike(half, shipped, 0.5);
}

// The volume is the same for the scene's step, half and twice that step, and for few and many
// iterations.
static void steps_and_iterations_take_as_much(void **state)
{
	(void)state;
	// `alike` is the largest relative difference; a cell is a fiftieth of the cut.
	static const double fineness = 0.5, alike = 0.1;
	static const struct {
		double step_s;
		int32_t iterations; // 0: the scene's number
	} other[] = {{1.0 / 60, 0}, {1.0 / 120, 0}, {1.0 / 30, 5}, {1.0 / 30, 20}};
	enum { OTHERS = CAU_TEST_SANITIZED ? 1 : sizeof other / sizeof *other, OF_WAYS = 2 };
	double usual = 0, taken[OTHERS] = {0};
	for (int way = 0; way < OF_WAYS && way < WAYS; way++) {
		cau_scene_def *scene = scene_of(fineness, CAU_PARTING_ELEMENTS, way);
		usual += volume_taken_m3(scene);
		for (int i = 0; i < OTHERS; i++) {
			scene->step_s = other[i].step_s;
			if (other[i].iterations) {
				scene->accuracy = 0;
				scene->iterations = other[i].iterations;
			}
			taken[i] += volume_taken_m3(scene);
		}
		free(scene);
	}
	for (int i = 0; i < OTHERS; i++) {
		print_message("steps of %.4f s, %d iterations: %+.1f %%\n", other[i].step_s,
		              other[i].iterations, 100 * (taken[i] / usual - 1));
		assert_true(fabs(taken[i] / usual - 1) <= alike);
	}
}

// Each shipped scene parts by edges or by elements, as listed.
static void scenes_have_their_rule(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		int parting;
	} scenes[] = {{"layers", CAU_PARTING_ELEMENTS},
	              {"fascia", CAU_PARTING_EDGES},
	              {"fat", CAU_PARTING_EDGES},
	              {"fat-neohookean", CAU_PARTING_EDGES}};
	for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
		cau_scene_def *scene = stage_scene_named(scenes[i].name);
		assert_int_equal(scene->parting, scenes[i].parting);
		free(scene);
	}
}

// This test takes minutes.
static void finer_cells_take_as_much(void **state)
{
	(void)state;
	static const double finer[] = {1.5, 2};
	double shipped = mean_volume_m3(1, CAU_PARTING_ELEMENTS);
	for (size_t k = 0; k < sizeof finer / sizeof *finer; k++)
		assert_alike(mean_volume_m3(finer[k], CAU_PARTING_ELEMENTS), shipped, finer[k]);
}

int main(int count, char **argument)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(half_the_cells_take_as_much),
		cmocka_unit_test(steps_and_iterations_take_as_much),
		cmocka_unit_test(scenes_have_their_rule),
	};
	const struct CMUnitTest long_tests[] = {cmocka_unit_test(finer_cells_take_as_much)};
	if (count > 1 && strcmp(argument[1], "--long") == 0)
		return cmocka_run_group_tests(long_tests, NULL, NULL);
	return cmocka_run_group_tests(tests, NULL, NULL);
}

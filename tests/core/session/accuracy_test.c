// SPDX-License-Identifier: GPL-3.0-or-later
// Steps that end when they reach the wanted accuracy. Each sampled step is compared with the same
// step, converged from the same state: its true error must be as wanted, and close to the reported
// error.
#include "core/session/stage.h"

#include "core/rig/step_error.h"
#include "session/session_internal.h"

enum { CONVERGED = 300, MOST = 60, MOST_SAMPLES = 400 };
// Relative residual at which a step is taken as converged, in the norm in which steps are measured.
static const double converged_residual = 1e-7;

// ---- scenes

// Returns a scene: a taut sheet, pinned at its rim, with a hook that is pressed in and drawn.
static cau_scene_def *make_taut(void)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	cau_default_gravity(scene->gravity_m_s2);
	stage_add_taut_sheet(scene);
	stage_add_tool(scene, "hook", CAU_TOOL_HOOK, 0, 0, 0.03);
	return scene;
}

// Returns a scene: a block of fat on a pinned floor, with a hook that is pressed in and drawn.
static cau_scene_def *make_block(void)
{
	const double size[3] = {0.06, 0.04, 0.01}, least[3] = {-1, -1, -0.0101},
				 most[3] = {1, 1, -0.0099};
	const int32_t cells[3] = {20, 13, 4};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	cau_default_gravity(scene->gravity_m_s2);
	stage_add_slab(scene, "fat", size, cells);
	stage_add_membrane(scene, "membrane", "fat");
	stage_pin_box(scene, least, most);
	stage_add_tool(scene, "hook", CAU_TOOL_HOOK, 0, 0, 0.03);
	return scene;
}

// Returns a scene: a sheet that hangs free from one edge. Its slow modes hardly converge.
static cau_scene_def *make_free(void)
{
	const double least[3] = {-1, 0.0249, -1}, most[3] = {1, 1, 1};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	cau_default_gravity(scene->gravity_m_s2);
	stage_add_sheet(scene, "fascia", 0.05, 0.05, 16, 16);
	stage_pin_box(scene, least, most);
	return scene;
}

// ---- errors

// Returns the error of the force on the first tool, relative to the exact force.
static double force_error(const cau_session *session, const cau_session *exact)
{
	double off = 0, force = 0;
	for (int c = 0; c < 3 && session->tool_count; c++) {
		double of = exact->tool[0].state.raw_force_n[c];
		force += of * of;
		off += pow(session->tool[0].state.raw_force_n[c] - of, 2);
	}
	return force > 1e-6 ? sqrt(off / force) : 0; // forces below a millinewton are not compared
}

typedef struct sampled {
	int32_t count, iterations;
	double error[MOST_SAMPLES], told[MOST_SAMPLES], force[MOST_SAMPLES];
} sampled;

static void sample(cau_session *session, cau_session *exact, sampled *of)
{
	assert_true(of->count < MOST_SAMPLES);
	stage_bytes shot = stage_snapshot(session);
	assert_int_equal(cau_session_restore(exact, shot.bytes, shot.count, NULL, NULL), CAU_OK);
	free(shot.bytes);
	stage_step(exact, 1);
	stage_step(session, 1);
	cau_frame frame = stage_frame(session);
	of->error[of->count] =
		step_error(session, exact->vertices.position, session->solver.accuracy.wanted);
	of->told[of->count] = frame.statistics.error;
	of->force[of->count++] = force_error(session, exact);
	of->iterations += frame.statistics.iterations;
}

// Runs a scene. Its tool comes down in half a second, then moves sideways at a centimetre a second,
// with energy off.
static sampled run(cau_scene_def *scene, int32_t most, int ticks, int every)
{
	sampled of = {0};
	scene->iterations = most;
	cau_session *session = stage_open(scene, 1), *exact = stage_open(scene, 1);
	exact->solver.accuracy.wanted = 0;
	exact->solver.settings.iterations = CONVERGED;
	exact->solver.settings.tolerance = converged_residual;
	for (int k = 0; k < ticks; k++) {
		if (session->tool_count)
			stage_move(session, "hook", 1.6e-4 * fmax(k - 30, 0), 0,
			           0.03 - 0.0285 * fmin(k / 30.0, 1));
		else
			stage_gravity(session, 0, 0, -9.81); // keeps the tissue awake
		if (k % every == 0)
			sample(session, exact, &of);
		else
			stage_step(session, 1);
	}
	cau_session_destroy(session);
	cau_session_destroy(exact);
	free(scene);
	return of;
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double quantile(const double *values, int32_t count, double share)
{
	double sorted[MOST_SAMPLES];
	memcpy(sorted, values, (size_t)count * sizeof *values);
	qsort(sorted, (size_t)count, sizeof *sorted, compare);
	return sorted[(int32_t)(share * (count - 1))];
}

// *flattered gets the share of samples with a true error of more than three times the reported
// error. *blackened gets the share with a reported error of more than `most` times the true error.
// Errors below a hundredth of the wanted accuracy do not count.
static void compare_told(const sampled *of, double most, double *flattered, double *blackened)
{
	const double nothing = 1e-4;
	*flattered = *blackened = 0;
	for (int32_t k = 0; k < of->count; k++) {
		*flattered += of->error[k] > 3 * of->told[k] && of->error[k] > nothing;
		*blackened += of->told[k] > most * of->error[k] && of->told[k] > 0.01;
	}
	*flattered /= of->count;
	*blackened /= of->count;
}

static void tell(const char *name, const sampled *of)
{
	double flattered, blackened;
	compare_told(of, 3, &flattered, &blackened);
	print_message("%s: %.2f iterations, error p50 %.2g p95 %.2g most %.2g, force p95 %.2g, "
	              "flattered %.3f, blackened %.3f\n",
	              name, (double)of->iterations / of->count, quantile(of->error, of->count, 0.5),
	              quantile(of->error, of->count, 0.95), quantile(of->error, of->count, 1),
	              quantile(of->force, of->count, 0.95), flattered, blackened);
}

static void expect_right(const char *name, const sampled *of)
{
	double flattered, blackened;
	tell(name, of);
	compare_told(of, 3, &flattered, &blackened);
	assert_true(quantile(of->error, of->count, 0.95) <= 0.01);
	assert_true(quantile(of->force, of->count, 0.95) <= 0.02);
	assert_true(flattered <= 0.01);
	assert_true(blackened <= 0.1);
}

static void a_taut_sheet_is_right(void **state)
{
	(void)state;
	for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++) {
		cau_scene_def *scene = make_taut();
		scene->precision = precision;
		sampled of = run(scene, MOST, CAU_TEST_SANITIZED ? 40 : 120, CAU_TEST_SANITIZED ? 8 : 2);
		expect_right("taut", &of);
		// It would be 3 with contact of vertices alone: contact points of faces move with the tool.
		assert_true(of.iterations <= 10 * of.count);
	}
}

static void fat_is_right(void **state)
{
	(void)state;
	for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++) {
		cau_scene_def *scene = make_block();
		scene->precision = precision;
		sampled of = run(scene, MOST, CAU_TEST_SANITIZED ? 36 : 100, CAU_TEST_SANITIZED ? 12 : 3);
		expect_right("fat", &of);
		// The bound would be 14 with contact of vertices alone: contact points of faces move with
		// the tool.
		assert_true(of.iterations <= 17 * of.count);
	}
}

// A steady push needs no second increment to report its force. A push that jumps needs a second
// increment in the same tick, because a blow differs from the steady steps from which the solver
// learned.
static void a_steady_push_takes_one_increment_and_a_blow_more(void **state)
{
	(void)state;
	enum { PRESSED = 60, HELD = 48 };
	cau_scene_def *scene = make_taut();
	scene->iterations = MOST;
	cau_session *session = stage_open(scene, 1), *exact = stage_open(scene, 1);
	sampled of = {0}, blow = {0};
	exact->solver.accuracy.wanted = 0;
	exact->solver.settings.iterations = CONVERGED;
	exact->solver.settings.tolerance = converged_residual;
	for (int k = 0; k < PRESSED + HELD; k++) {
		stage_gravity(session, 0, 0, -9.81 - 1e-3 * (k % 2)); // keeps the tissue awake
		stage_move(session, "hook", 0, 0, 0.03 - 0.0285 * fmin(k / 30.0, 1));
		if (k < PRESSED) {
			stage_step(session, 1);
			continue;
		}
		session->solver.accuracy.amplification[0] = 1e-9; // no vertex asks for a second increment
		sample(session, exact, &of);
	}
	tell("steady", &of);
	assert_true(session->tool[0].state.raw_force_n[2] > 0.05);
	assert_true(of.iterations <= 1.5 * of.count);
	assert_true(quantile(of.force, of.count, 1) <= 0.02);
	session->solver.accuracy.amplification[0] = 1e-9;
	// The solver does not measure its errors in this step.
	session->solver.accuracy.shallow_steps = 0;
	stage_move(session, "hook", 0, 0, -0.003);
	sample(session, exact, &blow);
	assert_true(blow.iterations >= 2);
	assert_true(blow.force[0] <= 0.02);
	cau_session_destroy(session);
	cau_session_destroy(exact);
	free(scene);
}

// A free sheet does not reach 1 % in so few iterations. Its steps use all iterations, and report
// their error.
static void what_is_not_reached_is_told(void **state)
{
	(void)state;
	double flattered, blackened;
	sampled of = run(make_free(), 10, CAU_TEST_SANITIZED ? 20 : 60, CAU_TEST_SANITIZED ? 5 : 2);
	tell("free", &of);
	compare_told(&of, 10, &flattered, &blackened);
	assert_true(flattered <= 0.01);
	for (int32_t k = 0; k < of.count; k++)
		assert_true(of.error[k] <= 0.03 || of.told[k] > 0.01);
}

// ---- number of iterations

static void without_accuracy_each_step_takes_as_many(void **state)
{
	(void)state;
	cau_scene_def *scene = make_taut();
	scene->accuracy = 0;
	scene->iterations = 7;
	cau_session *session = stage_open(scene, 1);
	for (int k = 0; k < 20; k++) {
		stage_gravity(session, 0, 0, -9.81 - k); // keeps the tissue awake
		stage_step(session, 1);
		assert_int_equal(stage_frame(session).statistics.iterations, 7);
		assert_true(stage_frame(session).statistics.error == 0);
	}
	cau_session_destroy(session);
	free(scene);
}

// A scene's tolerance takes precedence over its accuracy.
static void a_tolerance_goes_before_accuracy(void **state)
{
	(void)state;
	cau_scene_def *scene = make_block();
	scene->iterations = CONVERGED;
	scene->tolerance = 1e-6;
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 1);
	assert_true(stage_frame(session).statistics.residual <= 1e-6);
	cau_session_destroy(session);
	free(scene);
}

// A snapshot of another accuracy can be restored, but later ticks differ.
static void a_snapshot_of_another_accuracy_is_not_exact(void **state)
{
	(void)state;
	cau_scene_def *scene = make_block();
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 2);
	stage_bytes shot = stage_snapshot(session);
	scene->accuracy = 0.05;
	cau_session *other = stage_open(scene, 1);
	bool exact = true;
	assert_int_equal(cau_session_restore(other, shot.bytes, shot.count, &exact, NULL), CAU_OK);
	assert_false(exact);
	assert_int_equal(cau_session_restore(session, shot.bytes, shot.count, &exact, NULL), CAU_OK);
	assert_true(exact);
	free(shot.bytes);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_taut_sheet_is_right),
		cmocka_unit_test(fat_is_right),
		cmocka_unit_test(a_steady_push_takes_one_increment_and_a_blow_more),
		cmocka_unit_test(what_is_not_reached_is_told),
		cmocka_unit_test(without_accuracy_each_step_takes_as_many),
		cmocka_unit_test(a_tolerance_goes_before_accuracy),
		cmocka_unit_test(a_snapshot_of_another_accuracy_is_not_exact),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The iteration of a step: it converges where the gradient vanishes, never raises the objective,
// survives leaps, and gives the same result for any number of threads.
#include <string.h>

#include "core/rig/solve_scenes.h"

static const double LEAP_M = 0.025; // the grip's motion in one tick
// Largest net force and torque at convergence, relative to the sums of the absolute values.
static const double BALANCE_TOLERANCE = 1e-6;
// Largest relative change of momentum in a converged step, which is rounding in double.
static const double MOMENTUM_TOLERANCE = 1e-9;

// Makes a block that is pinned at its bottom and gripped at its top.
static void make_gripped(rig *r, int model, int precision, int32_t threads)
{
	rig_begin(r);
	r->scene->precision = precision;
	rig_add_slab(r, 6, 5, 4)->fat[0].model = model;
	rig_pin_box(r, (double[]){-1, -1, -1}, (double[]){1, 1, -0.0299});
	rig_pin_box(r, (double[]){-1, -1, -1e-6}, (double[]){0, 1, 1});
	rig_build(r, NULL, threads);
	rig_factor(r);
}

static void leap(rig *r, double x, double z)
{
	for (int32_t v = 0; v < r->tissue.vertex_count; v++)
		if (r->fixed[v] && r->tissue.rest[3 * v + 2] > -1e-6) {
			r->solver.position[3 * v] += x;
			r->solver.position[3 * v + 2] += z;
		}
}

// Computes one tick of eq. 1 and 2 without load: s = x, so the velocity is discarded.
static void tick(rig *r)
{
	memcpy(r->solver.predicted, r->solver.position,
	       3 * (size_t)r->tissue.vertex_count * sizeof(double));
	assert_int_equal(cau_solver_run(&r->solver, NULL), CAU_OK);
}

static void test_a_leap_stays_bounded(void **state)
{
	(void)state;
	static const int models[] = {CAU_MODEL_STVK, CAU_MODEL_NEOHOOKEAN, CAU_MODEL_COROTATED};
	int32_t backtracks = 0;
	for (size_t m = 0; m < 3; m++)
		for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++)
			for (int direction = 0; direction < 3; direction++) {
				rig r;
				make_gripped(&r, models[m], precision, 1);
				leap(&r, direction == 1 ? LEAP_M : 0,
				     direction == 0   ? LEAP_M
				     : direction == 2 ? -LEAP_M
				                      : 0);
				memcpy(r.solver.predicted, r.solver.position,
				       3 * (size_t)r.tissue.vertex_count * sizeof(double));
				double before = cau_solver_evaluate(&r.solver);
				for (int t = 0; t < 20; t++) {
					tick(&r);
					backtracks += r.solver.result.backtracks;
				}
				double after = cau_solver_evaluate(&r.solver);
				assert_true(isfinite(after) && after < before);
				for (int32_t i = 0; i < 3 * r.tissue.vertex_count; i++)
					assert_true(fabs(r.solver.position[i] - r.tissue.rest[i]) < 2 * LEAP_M);
				rig_finish(&r);
			}
	assert_true(backtracks > 0); // backtracking was needed
}

// After any number of iterations, the objective has not risen by more than rounding.
static void test_the_objective_never_rises(void **state)
{
	(void)state;
	static const int models[] = {CAU_MODEL_STVK, CAU_MODEL_NEOHOOKEAN};
	for (size_t m = 0; m < 2; m++) {
		double last = INFINITY;
		for (int32_t iterations = 1; iterations <= 15; iterations++) {
			rig r;
			make_gripped(&r, models[m], CAU_PRECISION_DOUBLE, 1);
			leap(&r, 0, LEAP_M);
			r.solver.settings.iterations = iterations;
			tick(&r);
			double value = cau_solver_evaluate(&r.solver);
			assert_true(value <= last * (1 + 1e-12));
			last = value;
			rig_finish(&r);
		}
	}
}

// Vertices are pushed through the opposite faces of their elements. The block recovers: no element
// stays inverted.
static void test_inverted_elements_recover(void **state)
{
	(void)state;
	static const int models[] = {CAU_MODEL_NEOHOOKEAN, CAU_MODEL_COROTATED};
	for (size_t m = 0; m < 2; m++) {
		rig r;
		rig_begin(&r);
		rig_add_slab(&r, 4, 4, 3)->fat[0].model = models[m];
		rig_pin_box(&r, (double[]){-1, -1, -1}, (double[]){1, 1, -0.0299});
		rig_build(&r, NULL, 1);
		rig_factor(&r);
		uint64_t random = 121;
		for (int32_t i = 0; i < 3 * r.tissue.vertex_count; i++)
			if (!r.fixed[i / 3])
				r.solver.position[i] += random_between(&random, -0.03, 0.03);
		int32_t inverted[2] = {0, 0};
		for (int t = 0; t <= 150; t++) {
			if (t)
				tick(&r);
			else
				cau_solver_evaluate(&r.solver);
			for (int32_t w = 0; w < r.solver.slots.work_count && (t == 0 || t == 150); w++)
				inverted[t > 0] += r.solver.kernels->settle(
					&r.solver.elements, &r.solver.slots.work[w], r.solver.iterate.displacement);
		}
		assert_true(inverted[0] > 20);
		assert_int_equal(inverted[1], 0);
		rig_finish(&r);
	}
}

// A free body is deformed, and spins and flies. Its elements' forces have no net force and no net
// torque, and a converged step keeps its momentum.
static void test_a_free_body_keeps_its_momentum(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	rig_add_slab(&r, 4, 3, 2);
	rig_build(&r, NULL, 1);
	rig_factor(&r);
	uint64_t random = 131;
	double a[3][3], turn[3][3], before[3] = {0}, after[3] = {0}, size = 0, dt = r.solver.step_s;
	size_t n = 3 * (size_t)r.tissue.vertex_count;
	double *x = cau_arena_array(&r.arena, n, sizeof(double));
	rig_random_gradient(&random, 0.1, a);
	rig_deform(&r, a, 5e-4, &random, x);
	mat_rotation((double[]){1, 2, 3}, 0.1, turn);
	for (int32_t v = 0; v < r.tissue.vertex_count; v++) {
		mat_apply(turn, x + 3 * v, r.solver.predicted + 3 * v);
		r.solver.predicted[3 * v] += 0.004;
		for (int c = 0; c < 3; c++) {
			double speed = (r.solver.predicted[3 * v + c] - x[3 * v + c]) / dt;
			before[c] += r.tissue.mass[v] * speed;
			size += r.tissue.mass[v] * fabs(speed);
		}
	}
	memcpy(r.solver.position, x, n * sizeof(double));
	r.solver.settings.iterations = 300;
	r.solver.settings.tolerance = 1e-12;
	assert_int_equal(cau_solver_run(&r.solver, NULL), CAU_OK);
	double *gradient = cau_arena_array(&r.arena, n, sizeof(double));
	rig_local(&r, r.solver.position, gradient);
	double force[3] = {0}, torque[3] = {0}, force_sum = 0, torque_sum = 0;
	for (int32_t v = 0; v < r.tissue.vertex_count; v++) {
		const double *f = gradient + 3 * v, *p = r.solver.position + 3 * v;
		double length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
		force_sum += length;
		torque_sum += length * sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
		for (int c = 0; c < 3; c++) {
			force[c] += f[c];
			torque[c] += p[(c + 1) % 3] * f[(c + 2) % 3] - p[(c + 2) % 3] * f[(c + 1) % 3];
			after[c] += r.tissue.mass[v] * (p[c] - x[3 * v + c]) / dt;
		}
	}
	assert_true(force_sum > 0);
	for (int c = 0; c < 3; c++) {
		assert_true(fabs(force[c]) < BALANCE_TOLERANCE * force_sum);
		assert_true(fabs(torque[c]) < BALANCE_TOLERANCE * torque_sum);
		assert_near(after[c], before[c], MOMENTUM_TOLERANCE * size);
	}
	rig_finish(&r);
}

static void test_threads_change_nothing(void **state)
{
	(void)state;
	static const int32_t threads[] = {1, 2, 3, 7};
	for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++) {
		rig first;
		make_gripped(&first, CAU_MODEL_NEOHOOKEAN, precision, 1);
		leap(&first, 0.004, 0.01);
		tick(&first);
		size_t bytes = 3 * (size_t)first.tissue.vertex_count * sizeof(double);
		for (size_t k = 1; k < sizeof threads / sizeof *threads; k++) {
			rig r;
			make_gripped(&r, CAU_MODEL_NEOHOOKEAN, precision, threads[k]);
			leap(&r, 0.004, 0.01);
			tick(&r);
			assert_memory_equal(r.solver.position, first.solver.position, bytes);
			rig_finish(&r);
		}
		rig_finish(&first);
	}
}

static void test_stops_at_rest_and_at_the_tolerance(void **state)
{
	(void)state;
	rig r;
	make_gripped(&r, CAU_MODEL_NEOHOOKEAN, CAU_PRECISION_DOUBLE, 1);
	size_t bytes = 3 * (size_t)r.tissue.vertex_count * sizeof(double);
	tick(&r);
	assert_int_equal(r.solver.result.iterations, 1); // the tissue is at its solution already
	assert_memory_equal(r.solver.position, r.tissue.rest, bytes);
	r.solver.settings.iterations = 200;
	r.solver.settings.tolerance = 1e-3;
	leap(&r, 0, 0.002);
	tick(&r);
	assert_true(r.solver.result.residual <= 1e-3);
	assert_in_range(r.solver.result.iterations, 2, 60);
	rig_finish(&r);
}

static void test_what_is_not_a_number_is_refused(void **state)
{
	(void)state;
	rig r;
	cau_error error = {0};
	make_gripped(&r, CAU_MODEL_NEOHOOKEAN, CAU_PRECISION_DOUBLE, 1);
	r.solver.position[300] = NAN;
	assert_int_equal(cau_solver_run(&r.solver, &error), CAU_NUMERICAL);
	assert_true(error.reason[0]);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_a_leap_stays_bounded),
		cmocka_unit_test(test_the_objective_never_rises),
		cmocka_unit_test(test_inverted_elements_recover),
		cmocka_unit_test(test_a_free_body_keeps_its_momentum),
		cmocka_unit_test(test_threads_change_nothing),
		cmocka_unit_test(test_stops_at_rest_and_at_the_tolerance),
		cmocka_unit_test(test_what_is_not_a_number_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

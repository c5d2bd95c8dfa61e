// SPDX-License-Identifier: GPL-3.0-or-later
// Objective and gradient of eq. 4: inertia, elements and drag together.
#include <string.h>

#include "core/rig/solve_scenes.h"

// Step, m, of central differences, 1e-5 of the slab's thickness, and their largest relative error.
// Truncation and rounding are near 1e-9.
static const double DIFFERENCE_STEP_M = 1e-7, DIFFERENCE_TOLERANCE = 1e-6;

static void make(rig *r, int32_t threads)
{
	uint64_t random = 111;
	double a[3][3];
	rig_begin(r);
	rig_add_slab(r, 3, 3, 2);
	rig_pin_box(r, (double[]){-1, -1, -1}, (double[]){1, 1, -0.0299});
	rig_build(r, NULL, threads);
	rig_random_gradient(&random, 0.1, a);
	rig_deform(r, a, 1e-3, &random, r->solver.position);
	rig_deform(r, a, 1e-2, &random, r->solver.predicted);
	r->solver.forces.drag = cau_arena_array(&r->arena, 3, sizeof *r->solver.forces.drag);
	r->solver.forces.drag_count = 3;
	for (int k = 0; k < 3; k++) // vertex 0 is pinned, the last vertex is free
		r->solver.forces.drag[k] = (cau_drag){7 * k, 40.0 + k, {0.01, 0.02 * k, -0.01}};
}

static void test_gradient_is_that_of_the_objective(void **state)
{
	(void)state;
	rig r;
	make(&r, 1);
	size_t n = 3 * (size_t)r.tissue.vertex_count;
	double *gradient = cau_arena_array(&r.arena, n, sizeof(double));
	double *numeric = cau_arena_array(&r.arena, n, sizeof(double));
	cau_solver_evaluate(&r.solver);
	for (size_t i = 0; i < n; i++)
		gradient[i] = cau_real_get(r.solver.iterate.gradient, 0, (int64_t)(4 * (i / 3) + i % 3));
	for (size_t i = 0; i < n; i++) {
		double at = r.solver.position[i];
		if (r.fixed[i / 3]) {
			assert_true(gradient[i] == 0);
			continue;
		}
		r.solver.position[i] = at + DIFFERENCE_STEP_M;
		double above = cau_solver_evaluate(&r.solver);
		r.solver.position[i] = at - DIFFERENCE_STEP_M;
		numeric[i] = (above - cau_solver_evaluate(&r.solver)) / (2 * DIFFERENCE_STEP_M);
		r.solver.position[i] = at;
	}
	assert_true(rig_difference(gradient, numeric, n) < DIFFERENCE_TOLERANCE);
	rig_finish(&r);
}

// With inertia and drag only, the objective is known in closed form.
static void test_inertia_and_drag_by_hand(void **state)
{
	(void)state;
	rig r;
	make(&r, 1);
	for (int32_t t = 0; t < r.tissue.tetrahedron_count; t++)
		rig_remove(&r, CAU_ELEMENT_TETRAHEDRON, t, 0);
	double expected = 0, dt = r.solver.step_s;
	for (int32_t i = 0; i < 3 * r.tissue.vertex_count; i++) {
		double away = r.solver.position[i] - r.solver.predicted[i];
		expected += r.tissue.mass[i / 3] / (dt * dt) * away * away / 2;
	}
	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 3 && !r.fixed[r.solver.forces.drag[k].vertex]; c++) {
			double away = r.solver.position[3 * r.solver.forces.drag[k].vertex + c] -
			              r.solver.forces.drag[k].target[c];
			expected += r.solver.forces.drag[k].coefficient * away * away / 2;
		}
	// the tolerance is rounding, because the additions have another order
	assert_near(cau_solver_evaluate(&r.solver), expected, 1e-13 * expected);
	assert_true(cau_solver_elastic_energy(&r.solver) == 0);
	rig_finish(&r);
}

static void test_threads_change_nothing(void **state)
{
	(void)state;
	static const int32_t threads[] = {1, 2, 3, 7};
	double first = 0;
	for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
		rig r;
		make(&r, threads[k]);
		double value = cau_solver_evaluate(&r.solver);
		assert_true(!k || value == first);
		first = value;
		rig_finish(&r);
	}
}

// Work that one thread does during the first local step of a tick is done once. The result is the
// same as without this work.
static void count(void *context)
{
	++*(int *)context; // only one thread changes it
}

static void test_other_work_may_be_done_beside(void **state)
{
	(void)state;
	static const int32_t threads[] = {1, 2, 3, 7};
	for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
		rig r;
		make(&r, threads[k]);
		size_t reals = 4 * (size_t)r.tissue.vertex_count;
		size_t bytes = reals * cau_real_bytes(r.solver.elements.single);
		double value = cau_solver_evaluate(&r.solver);
		void *gradient = cau_arena_copy(&r.arena, r.solver.iterate.gradient, bytes, 1);
		int done = 0;
		assert_true(cau_solver_evaluate_beside(&r.solver, count, &done) == value);
		assert_memory_equal(r.solver.iterate.gradient, gradient, bytes);
		assert_int_equal(done, 1);
		rig_finish(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_gradient_is_that_of_the_objective),
		cmocka_unit_test(test_inertia_and_drag_by_hand),
		cmocka_unit_test(test_threads_change_nothing),
		cmocka_unit_test(test_other_work_may_be_done_beside),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

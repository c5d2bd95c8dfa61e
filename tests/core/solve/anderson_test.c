// SPDX-License-Identifier: GPL-3.0-or-later
// Acceleration changes the path, not the result: the accelerated step and the plain iteration x <-
// x - A^-1 grad E converge to the same point, the accelerated one in fewer iterations.
#include <string.h>

#include "core/rig/law_scenes.h"
#include "core/rig/solve_scenes.h"

// Length of the last step, relative to the first step, at which both iterations stop. Each step of
// the plain iteration is less than 0.98 times the step before, so the remaining distance is at most
// 50 times the last step.
static const double STILL = 1e-11;
static const double FIXED_POINT_TOLERANCE =
	1e-8; // largest distance of the results, over the motion
enum { PLAIN_MOST = 6000, ACCELERATED_MOST = 600 };

// Builds the law's mesh with a load. Sheets are made heavy and soft. With normal values the plain
// iteration would need many thousands of steps across a sheet.
static void make(rig *r, const law_scene *law)
{
	rig_begin(r);
	r->scene->step_s = 1.0 / 50;
	law->add(r);
	for (int32_t i = 0; i < r->scene->layer_count; i++) {
		cau_sheet_material *material = &r->scene->layers[i].sheet[0];
		material->limit_stiffness_pa = 2e4;
		material->density_kg_m3 = 25000;
		material->bending_stiffness_nm *= 0.01;
	}
	rig_pin_box(r, (double[]){-1, -1, -1}, (double[]){-0.0199, 1, 1});
	rig_build(r, NULL, 1);
	rig_factor(r);
	for (int32_t v = 0; v < r->tissue.vertex_count; v++)
		if (!r->fixed[v]) {
			r->solver.predicted[3 * v] += 3e-3;
			r->solver.predicted[3 * v + 2] -= 2e-3;
		}
}

static double plain_step(rig *r)
{
	cau_step_solver *solver = &r->solver;
	cau_solver_evaluate(solver);
	cau_solver_apply_inverse(solver, solver->iterate.gradient, solver->iterate.increment, -1);
	double product = 0;
	for (int32_t i = 0; i < 3 * r->tissue.vertex_count; i++) {
		double d = ((double *)solver->iterate.increment)[4 * (i / 3) + i % 3];
		solver->position[i] += d;
		product -= d * ((double *)solver->iterate.gradient)[4 * (i / 3) + i % 3];
	}
	return sqrt(fmax(product, 0));
}

static void test_the_same_fixed_point(void **state)
{
	(void)state;
	for (int k = 0; k < LAW_SCENES; k++) {
		rig a, b;
		make(&a, &law_scenes[k]);
		make(&b, &law_scenes[k]);
		size_t n = 3 * (size_t)a.tissue.vertex_count;
		double first = plain_step(&a), norm = first;
		int steps = 1;
		for (; steps < PLAIN_MOST && norm > STILL * first; steps++)
			norm = plain_step(&a);
		if (!(norm <= STILL * first))
			fail_msg("%s: the plain iteration is still at %g", law_scenes[k].name, norm / first);
		b.solver.settings.iterations = ACCELERATED_MOST;
		b.solver.settings.tolerance = STILL;
		assert_int_equal(cau_solver_run(&b.solver, NULL), CAU_OK);
		double moved_a = 0, off = 0;
		for (size_t i = 0; i < n; i++) {
			moved_a = fmax(moved_a, fabs(a.solver.position[i] - a.tissue.rest[i]));
			off = fmax(off, fabs(a.solver.position[i] - b.solver.position[i]));
		}
		if (!(off < FIXED_POINT_TOLERANCE * moved_a))
			fail_msg("%s: %g of %g apart after %d and %d steps, residual %g", law_scenes[k].name,
			         off, moved_a, steps, b.solver.result.iterations, b.solver.result.residual);
		if (!(b.solver.result.iterations < steps))
			fail_msg("%s: %d accelerated steps, %d plain", law_scenes[k].name,
			         b.solver.result.iterations, steps);
		rig_finish(&a);
		rig_finish(&b);
	}
}

// For a pulled block, ten accelerated steps come closer to the solution than ten plain ones.
static void test_sooner(void **state)
{
	(void)state;
	double off[2];
	for (int accelerated = 0; accelerated < 2; accelerated++) {
		rig r, end;
		rig *both[2] = {&r, &end};
		for (int k = 0; k < 2; k++) {
			rig_begin(both[k]);
			solve_scenes[1].add(both[k]);
			rig_build(both[k], NULL, 1);
			rig_factor(both[k]);
			for (int32_t v = 0; v < both[k]->tissue.vertex_count; v++)
				if (both[k]->tissue.rest[3 * v + 2] > -1e-9)
					both[k]->solver.predicted[3 * v + 2] += 0.01;
		}
		end.solver.settings.iterations = 400;
		end.solver.settings.tolerance = 1e-10;
		assert_int_equal(cau_solver_run(&end.solver, NULL), CAU_OK);
		assert_true(end.solver.result.residual <= 1e-10);
		r.solver.settings.iterations = 10;
		for (int step = 0; step < 10 && !accelerated; step++)
			plain_step(&r);
		if (accelerated)
			assert_int_equal(cau_solver_run(&r.solver, NULL), CAU_OK);
		off[accelerated] = 0;
		for (int32_t i = 0; i < 3 * r.tissue.vertex_count; i++)
			off[accelerated] =
				fmax(off[accelerated], fabs(r.solver.position[i] - end.solver.position[i]));
		rig_finish(&r);
		rig_finish(&end);
	}
	assert_true(off[1] < 0.5 * off[0]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_the_same_fixed_point),
		cmocka_unit_test(test_sooner),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

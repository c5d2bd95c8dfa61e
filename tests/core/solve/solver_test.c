// SPDX-License-Identifier: GPL-3.0-or-later
// Which laws can be safeguarded by their energy, and systems without a free row.
#include <string.h>

#include "core/rig/law_scenes.h"

static void test_laws_with_an_energy(void **state)
{
	(void)state;
	for (int k = 0; k < LAW_SCENES; k++) {
		rig r;
		rig_begin(&r);
		law_scenes[k].add(&r);
		rig_build(&r, NULL, 1);
		assert_int_equal(cau_solver_is_conservative(&r.tissue, 0), law_scenes[k].has_energy);
		// printed projections have no energy
		assert_int_equal(cau_solver_is_conservative(&r.tissue, 1), 0);
		assert_int_equal(r.solver.settings.conservative, law_scenes[k].has_energy);
		rig_finish(&r);
	}
}

// If all vertices are pinned, there is no factor, and a step changes nothing.
static void test_nothing_free(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	rig_add_slab(&r, 2, 2, 2);
	rig_pin_box(&r, (double[]){-1, -1, -1}, (double[]){1, 1, 1});
	rig_build(&r, NULL, 1);
	rig_factor(&r);
	r.solver.predicted[5] += 0.1;
	assert_int_equal(cau_solver_run(&r.solver, NULL), CAU_OK);
	assert_memory_equal(r.solver.position, r.tissue.rest,
	                    3 * (size_t)r.tissue.vertex_count * sizeof(double));
	rig_finish(&r);
}

// The diagonal system's step is that of the paper: gradient over diagonal.
static void test_diagonal_step(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	r.scene->solver = CAU_SOLVER_DIAGONAL;
	rig_add_slab(&r, 3, 2, 2);
	rig_build(&r, NULL, 1);
	rig_factor(&r);
	size_t n = (size_t)r.tissue.vertex_count;
	double *in = (double *)r.solver.iterate.gradient, *out = (double *)r.solver.iterate.increment;
	for (size_t i = 0; i < 4 * n; i++)
		in[i] = (double)(i % 7) - 3;
	cau_solver_apply_inverse(&r.solver, r.solver.iterate.gradient, r.solver.iterate.increment, -1);
	for (size_t i = 0; i < 3 * n; i++) {
		double expected = -in[4 * (i / 3) + i % 3] / r.solver.system.diagonal[i / 3];
		assert_true(out[4 * (i / 3) + i % 3] == expected);
	}
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_laws_with_an_energy),
		cmocka_unit_test(test_nothing_free),
		cmocka_unit_test(test_diagonal_step),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

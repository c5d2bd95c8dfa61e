// SPDX-License-Identifier: GPL-3.0-or-later
// The loops over vectors in both precisions: they write the value computed in double, rounded once.
#include <stdlib.h>
#include <string.h>

#include "core/rig/rig.h"

enum { VERTICES = 5 };

static void test_what_is_added_is_read(void **state)
{
	(void)state;
	for (int single = 0; single < 2; single++) {
		const cau_vectors *vectors = cau_kernels_choose(single, "baseline")->vectors;
		assert_int_equal(vectors->real_bytes, single ? sizeof(float) : sizeof(double));
		cau_reals *vector = calloc(4 * VERTICES, vectors->real_bytes);
		cau_reals *column = calloc(VERTICES, vectors->real_bytes);
		assert_true(vector && column);
		const double third[3] = {1 / 3.0, -2 / 3.0, 1e-20}, back[3] = {-1 / 3.0, 2 / 3.0, -1e-20};
		double got[3];
		vectors->add(vector, 2, third);
		vectors->read(vector, 2, got);
		for (int c = 0; c < 3; c++) {
			double rounded = single ? (double)(float)third[c] : third[c];
			assert_true(got[c] == rounded);
			assert_true(vectors->at(vector, 4 * 2 + c) == rounded);
			vectors->take_coordinate(column, vector, c, VERTICES);
			for (int v = 0; v < VERTICES; v++)
				assert_true(vectors->at(column, v) == (v == 2 ? rounded : 0));
		}
		vectors->read(vector, 3, got); // the neighbouring vertex is unchanged
		assert_true(got[0] == 0 && got[1] == 0 && got[2] == 0);
		assert_near(vectors->longest(vector, VERTICES),
		            sqrt(third[0] * third[0] + third[1] * third[1] + third[2] * third[2]), 1e-5);
		// in float, a third minus its rounded value leaves the rounding error
		vectors->add(vector, 2, back);
		vectors->read(vector, 2, got);
		assert_near(got[0], 0, vectors->rounding);
		assert_int_equal(got[0] == 0, !single);
		free(vector);
		free(column);
	}
}

// displace and step are inverse to each other, for the vertices of the range. All other vertices
// are unchanged.
static void test_displacements_and_steps(void **state)
{
	(void)state;
	for (int single = 0; single < 2; single++) {
		rig r;
		rig_begin(&r);
		r.scene->precision = single ? CAU_PRECISION_SINGLE : CAU_PRECISION_DOUBLE;
		rig_add_sheet(&r, 3, 2);
		rig_build(&r, NULL, 1);
		cau_step_solver *solver = &r.solver;
		const cau_vectors *vectors = solver->kernels->vectors;
		int32_t n = r.tissue.vertex_count;
		for (int32_t i = 0; i < 3 * n; i++)
			solver->position[i] = r.tissue.rest[i] + 0.001 * i;
		memset(solver->iterate.displacement, 0, 4 * (size_t)n * vectors->real_bytes);
		vectors->displace(solver, 1, n);
		for (int32_t i = 0; i < 3 * n; i++) {
			double wanted = i < 3 ? 0 : solver->position[i] - r.tissue.rest[i];
			wanted = single ? (double)(float)wanted : wanted;
			assert_true(vectors->at(solver->iterate.displacement, 4 * (i / 3) + i % 3) == wanted);
		}
		memcpy(solver->iterate.before, r.tissue.rest, 3 * (size_t)n * sizeof(double));
		memcpy(solver->iterate.trial, solver->iterate.displacement,
		       4 * (size_t)n * vectors->real_bytes);
		vectors->step(solver, 0.5, 0, n);
		for (int32_t i = 0; i < 3 * n; i++) {
			double way = i < 3 ? 0 : 0.0005 * i;
			assert_near(solver->position[i], r.tissue.rest[i] + way, vectors->rounding);
		}
		rig_finish(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_what_is_added_is_read),
		cmocka_unit_test(test_displacements_and_steps),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

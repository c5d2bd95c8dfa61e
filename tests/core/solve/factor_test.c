// SPDX-License-Identifier: GPL-3.0-or-later
// The factor against the matrix that it factors, and a downdated factor against a fresh one.
#include <string.h>

#include "core/rig/solve_scenes.h"

// Largest |A x - b| relative to |A| |x|. A direct solve has a few dozen roundings.
static const double RESIDUAL_TOLERANCE = 1e-14;
// Largest relative difference between the solutions of a downdated and a fresh factor:
// DOWNDATE_TOLERANCE, or DOWNDATE_RATIO times the worst ratio of an element's stiffness to a
// vertex's inertia, whichever is larger.
static const double DOWNDATE_TOLERANCE = 1e-10, DOWNDATE_RATIO = 1e-13;

static void make(rig *r, int scene)
{
	rig_begin(r);
	solve_scenes[scene].add(r);
	rig_build(r, NULL, 1);
	rig_factor(r);
}

static double *random_load(rig *r, uint64_t *random)
{
	size_t n = 3 * (size_t)r->tissue.vertex_count;
	double *b = cau_arena_array(&r->arena, n, sizeof(double));
	for (size_t i = 0; i < n; i++)
		b[i] = r->tissue.pinned[i / 3] ? 0 : random_between(random, -1, 1);
	return b;
}

static double downdate_tolerance(const rig *r)
{
	double stiffest = 0, lightest = INFINITY, dt = r->solver.step_s;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t e = 0; e < cau_tissue_element_count(&r->tissue, kind); e++) {
			cau_element_map map;
			cau_tissue_element_map(&r->tissue, kind, e, &map);
			stiffest = fmax(stiffest, map.weight * cau_element_map_scale(&map) * map.vertex_count);
		}
	for (int32_t v = 0; v < r->tissue.vertex_count; v++)
		lightest = fmin(lightest, r->tissue.mass[v]);
	return fmax(DOWNDATE_TOLERANCE, DOWNDATE_RATIO * stiffest * dt * dt / lightest);
}

static void test_solves_the_matrix(void **state)
{
	(void)state;
	for (int s = 0; s < SOLVE_SCENES; s++) {
		rig r;
		make(&r, s);
		uint64_t random = 81;
		size_t n = (size_t)r.tissue.vertex_count;
		double *b = random_load(&r, &random), *x = random_load(&r, &random);
		double *a = cau_arena_array(&r.arena, n * n, sizeof(double));
		solve_dense_matrix(&r, a);
		solve_by_factor(&r, b, x);
		double largest = 0, off = 0, reach = 0;
		for (size_t v = 0; v < n; v++) {
			double sum[3] = {0}, row = 0;
			for (size_t u = 0; u < n; u++) {
				row += fabs(a[v * n + u]);
				for (size_t c = 0; c < 3; c++)
					sum[c] += a[v * n + u] * x[3 * u + c];
			}
			largest = fmax(largest, row);
			for (size_t c = 0; c < 3 && !r.tissue.pinned[v]; c++) {
				off = fmax(off, fabs(sum[c] - b[3 * v + c]));
				reach = fmax(reach, fabs(x[3 * v + c]));
			}
		}
		if (!(off < RESIDUAL_TOLERANCE * largest * reach))
			fail_msg("%s: residual %g of %g", solve_scenes[s].name, off, largest * reach);
		rig_finish(&r);
	}
}

// Downdates `count` random live elements, in updates of at most rank 8.
static void downdate_some(rig *r, uint64_t *random, int count)
{
	while (count > 0) {
		int32_t first[CAU_UPDATE_RANK + 1] = {0}, row[CAU_UPDATE_RANK * 8], columns = 0;
		double value[CAU_UPDATE_RANK * 8];
		for (int tries = 0; tries < 40 && count > 0; tries++) {
			int kind = (int)random_between(random, 0, CAU_ELEMENT_KINDS);
			int32_t most = cau_tissue_element_count(&r->tissue, kind);
			int32_t e = (int32_t)random_between(random, 0, most);
			cau_element_map map;
			if (!most || !r->dissection.alive.element[kind][e])
				continue;
			cau_tissue_element_map(&r->tissue, kind, e, &map);
			if (columns + map.rank > CAU_UPDATE_RANK)
				break;
			cau_system_columns(&r->solver.system, &map, &columns, first, row, value);
			r->dissection.alive.element[kind][e] = 0;
			count--;
		}
		assert_int_equal(cau_factor_update(r->solver.factor, columns, first, row, value, 0, NULL),
		                 CAU_OK);
	}
}

static void test_downdated_is_as_good_as_fresh(void **state)
{
	(void)state;
	static const int scenes[] = {0, 1, 2, 5};
	for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s++) {
		rig r;
		make(&r, scenes[s]);
		uint64_t random = 82;
		size_t n = 3 * (size_t)r.tissue.vertex_count;
		double *b = random_load(&r, &random), *x = random_load(&r, &random);
		double *fresh = random_load(&r, &random);
		downdate_some(&r, &random, 150);
		solve_by_factor(&r, b, x);
		cau_system *system = &r.solver.system;
		cau_system_assemble(system, &r.tissue, &r.dissection.alive, r.solver.step_s,
		                    system->matrix.value);
		assert_int_equal(cau_factor_refactor(r.solver.factor, &system->matrix, NULL), CAU_OK);
		solve_by_factor(&r, b, fresh);
		double off = rig_difference(x, fresh, n);
		if (!(off < downdate_tolerance(&r)))
			fail_msg("%s: %g, allowed %g", solve_scenes[scenes[s]].name, off,
			         downdate_tolerance(&r));
		assert_true(off > 0); // the two factors were computed in different ways
		rig_finish(&r);
	}
}

static void test_adding_takes_a_removal_back(void **state)
{
	(void)state;
	rig r;
	make(&r, 1);
	uint64_t random = 83;
	size_t n = 3 * (size_t)r.tissue.vertex_count;
	double *b = random_load(&r, &random), *x = random_load(&r, &random);
	double *before = random_load(&r, &random), *between = random_load(&r, &random);
	int32_t first[CAU_UPDATE_RANK + 1] = {0}, row[CAU_UPDATE_RANK * 8], columns = 0;
	double value[CAU_UPDATE_RANK * 8];
	cau_element_map map;
	cau_tissue_element_map(&r.tissue, CAU_ELEMENT_TETRAHEDRON, 100, &map);
	cau_system_columns(&r.solver.system, &map, &columns, first, row, value);
	solve_by_factor(&r, b, before);
	for (int add = 0; add < 2; add++) {
		assert_int_equal(cau_factor_update(r.solver.factor, columns, first, row, value, add, NULL),
		                 CAU_OK);
		solve_by_factor(&r, b, add ? x : between);
	}
	assert_true(rig_difference(between, before, n) > 1e-6); // the removal changed the solution
	assert_true(rig_difference(x, before, n) < DOWNDATE_TOLERANCE);
	rig_finish(&r);
}

static double column_sum(const cau_factor *factor)
{
	double sum = 0;
	for (int32_t j = 0; j < cau_factor_size(factor); j++) {
		const int32_t *row;
		const double *value;
		double pivot;
		int32_t count = cau_factor_column(factor, j, &row, &value, &pivot);
		sum += (j + 1) * pivot;
		for (int32_t k = 0; k < count; k++) {
			assert_true(row[k] > j && (!k || row[k] > row[k - 1]));
			sum += value[k] * row[k];
		}
	}
	return sum;
}

// A factor that is computed again depends on the values alone: it is bit for bit the same after any
// history, and with a given order.
static void test_a_new_factor_has_no_memory(void **state)
{
	(void)state;
	rig r;
	make(&r, 1);
	uint64_t random = 84;
	cau_system *system = &r.solver.system;
	double first = column_sum(r.solver.factor);
	downdate_some(&r, &random, 60);
	assert_true(column_sum(r.solver.factor) != first);
	assert_int_equal(cau_factor_refactor(r.solver.factor, &system->matrix, NULL), CAU_OK);
	assert_true(column_sum(r.solver.factor) == first);
	cau_factor *given = NULL;
	const int32_t *order = cau_factor_permutation(r.solver.factor);
	assert_int_equal(cau_factor_create(&given, &system->matrix, order, NULL), CAU_OK);
	assert_memory_equal(cau_factor_permutation(given), order,
	                    (size_t)system->row_count * sizeof(int32_t));
	assert_true(column_sum(given) == first);
	for (int32_t k = 0; k < system->row_count; k++)
		assert_int_equal(cau_factor_places(given)[order[k]], k);
	cau_factor_destroy(given);
	rig_finish(&r);
}

static void test_refusals(void **state)
{
	(void)state;
	int32_t first[3] = {0, 2, 3}, row[3] = {0, 1, 1};
	double value[3] = {1, 2, 1}; // [1 2; 2 1]: indefinite
	cau_matrix matrix = {2, first, row, value};
	cau_factor *factor = NULL;
	cau_error error = {0};
	assert_int_equal(cau_factor_create(&factor, &matrix, NULL, &error), CAU_NUMERICAL);
	assert_null(factor);
	assert_true(error.reason[0]);
	value[2] = 5;
	assert_int_equal(cau_factor_create(&factor, &matrix, NULL, &error), CAU_OK);
	assert_near(cau_factor_least_pivot(factor), 1, 1e-15);
	int32_t many[10] = {0};
	assert_int_equal(cau_factor_update(factor, CAU_UPDATE_RANK + 1, many, row, value, 0, &error),
	                 CAU_LIMIT);
	cau_factor_destroy(factor);
	cau_factor_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_solves_the_matrix),
		cmocka_unit_test(test_downdated_is_as_good_as_fresh),
		cmocka_unit_test(test_adding_takes_a_removal_back),
		cmocka_unit_test(test_a_new_factor_has_no_memory),
		cmocka_unit_test(test_refusals),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

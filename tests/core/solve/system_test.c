// SPDX-License-Identifier: GPL-3.0-or-later
// The sparse system against a dense one that is assembled element by element.
#include <string.h>

#include "core/rig/solve_scenes.h"

// Largest relative error of a sum of at most a hundred terms, added in another order.
static const double ASSEMBLY_TOLERANCE = 1e-13;

static double entry(const cau_matrix *matrix, int32_t a, int32_t b)
{
	int32_t column = a < b ? a : b, row = a < b ? b : a;
	for (int32_t k = matrix->first[column]; k < matrix->first[column + 1]; k++)
		if (matrix->row[k] == row)
			return matrix->value[k];
	return 0;
}

static void remove_some(rig *r, uint64_t *random, int count)
{
	for (int i = 0; i < count; i++) {
		int kind = (int)random_between(random, 0, CAU_ELEMENT_KINDS);
		int32_t most = cau_tissue_element_count(&r->tissue, kind);
		if (most)
			r->dissection.alive.element[kind][(int32_t)random_between(random, 0, most)] = 0;
	}
}

static void test_assembly_is_the_dense_matrix(void **state)
{
	(void)state;
	for (int s = 0; s < SOLVE_SCENES; s++) {
		rig r;
		rig_begin(&r);
		solve_scenes[s].add(&r);
		rig_build(&r, NULL, 1);
		uint64_t random = 71;
		cau_system *system = &r.solver.system;
		size_t n = (size_t)r.tissue.vertex_count;
		double *dense = cau_arena_array(&r.arena, n * n, sizeof(double));
		for (int pass = 0; pass < 2; pass++) {
			cau_system_assemble(system, &r.tissue, &r.dissection.alive, r.solver.step_s,
			                    system->matrix.value);
			solve_dense_matrix(&r, dense);
			double most = 0, size = 0;
			for (int32_t i = 0; i < system->row_count; i++)
				for (int32_t j = 0; j <= i; j++) {
					size_t u = (size_t)system->vertex_of_row[i],
						   v = (size_t)system->vertex_of_row[j];
					most = fmax(most, fabs(entry(&system->matrix, i, j) - dense[u * n + v]));
					size = fmax(size, fabs(dense[u * n + v]));
				}
			if (!(most <= ASSEMBLY_TOLERANCE * size))
				fail_msg("%s: off by %g of %g", solve_scenes[s].name, most, size);
			remove_some(&r, &random, 40);
		}
		rig_finish(&r);
	}
}

static void test_rows_are_the_free_vertices(void **state)
{
	(void)state;
	for (int s = 0; s < SOLVE_SCENES; s++) {
		rig r;
		rig_begin(&r);
		solve_scenes[s].add(&r);
		rig_build(&r, NULL, 1);
		const cau_system *system = &r.solver.system;
		int32_t free_count = 0;
		for (int32_t v = 0; v < r.tissue.vertex_count; v++) {
			assert_int_equal(system->row_of_vertex[v] < 0, r.tissue.pinned[v]);
			if (r.tissue.pinned[v])
				continue;
			free_count++;
			assert_int_equal(system->vertex_of_row[system->row_of_vertex[v]], v);
		}
		assert_int_equal(system->row_count, free_count);
		// each column has its diagonal first, then ascending rows
		for (int32_t c = 0; c < system->row_count; c++) {
			assert_int_equal(system->matrix.row[system->matrix.first[c]], c);
			for (int32_t k = system->matrix.first[c] + 1; k < system->matrix.first[c + 1]; k++)
				assert_true(system->matrix.row[k] > system->matrix.row[k - 1]);
		}
		rig_finish(&r);
	}
}

// C C^T of the appended columns is w G^T G over the free rows.
static void test_columns_are_the_root_of_an_element(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	solve_scenes[5].add(&r);
	rig_build(&r, NULL, 1);
	const cau_system *system = &r.solver.system;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t e = 0; e < cau_tissue_element_count(&r.tissue, kind); e++) {
			cau_element_map map;
			int32_t first[4] = {0}, row[12], columns = 0;
			double value[12];
			cau_tissue_element_map(&r.tissue, kind, e, &map);
			cau_system_columns(system, &map, &columns, first, row, value);
			assert_true(columns <= map.rank);
			for (int i = 0; i < map.vertex_count; i++)
				for (int j = 0; j < map.vertex_count; j++) {
					int32_t a = system->row_of_vertex[map.vertex[i]];
					int32_t b = system->row_of_vertex[map.vertex[j]];
					double got = 0, expected = 0, size = 0;
					for (int k = 0; k < map.rank; k++) {
						expected += map.weight * map.coefficient[k][i] * map.coefficient[k][j];
						size += map.weight * fabs(map.coefficient[k][i] * map.coefficient[k][j]);
					}
					for (int c = 0; c < columns; c++) {
						double x = 0, y = 0;
						for (int32_t k = first[c]; k < first[c + 1]; k++) {
							x += row[k] == a ? value[k] : 0;
							y += row[k] == b ? value[k] : 0;
						}
						got += x * y;
					}
					assert_near(got, a < 0 || b < 0 ? 0 : expected, ASSEMBLY_TOLERANCE * size);
				}
		}
	rig_finish(&r);
}

// Checks the diagonal of eq. 7: M/dt^2 + sum of omega_m over the elements of a vertex.
static void test_diagonal_is_equation_7(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	solve_scenes[5].add(&r);
	rig_build(&r, NULL, 1);
	uint64_t random = 72;
	remove_some(&r, &random, 100);
	double dt = r.solver.step_s;
	double *expected = cau_arena_array(&r.arena, (size_t)r.tissue.vertex_count, sizeof(double));
	for (int32_t v = 0; v < r.tissue.vertex_count; v++)
		expected[v] = r.tissue.mass[v] / (dt * dt);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t e = 0; e < cau_tissue_element_count(&r.tissue, kind); e++) {
			cau_element_map map;
			double squares = 0;
			cau_tissue_element_map(&r.tissue, kind, e, &map);
			for (int k = 0; k < map.rank; k++)
				for (int i = 0; i < map.vertex_count; i++)
					squares += map.coefficient[k][i] * map.coefficient[k][i];
			for (int i = 0; i < map.vertex_count && r.dissection.alive.element[kind][e]; i++)
				expected[map.vertex[i]] += map.weight * squares / map.vertex_count;
		}
	cau_system_assemble_diagonal(&r.solver.system, &r.tissue, &r.dissection.alive, dt);
	assert_true(rig_difference(r.solver.system.diagonal, expected, (size_t)r.tissue.vertex_count) <
	            ASSEMBLY_TOLERANCE);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_assembly_is_the_dense_matrix),
		cmocka_unit_test(test_rows_are_the_free_vertices),
		cmocka_unit_test(test_columns_are_the_root_of_an_element),
		cmocka_unit_test(test_diagonal_is_equation_7),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The diagonal system against the printed projections. For one constraint C and unit masses, dx_u =
// -C grad_u C / sum |grad C|^2 over all its vertices, weighted with omega = w |G|^2 / vertices.
#include "core/constraint/element.h"
#include "reference/stress.h"

enum { DRAWS = 40 };
// Largest relative error of forces: about forty roundings, because D_m^-1 is used on both sides.
static const double FORCE_TOLERANCE = 1e-11;

// Returns omega of the element.
static double omega_of(const rig *r, int kind)
{
	cau_element_map map;
	double sum = 0;
	cau_tissue_element_map(&r->tissue, kind, 0, &map);
	for (int row = 0; row < map.rank; row++)
		for (int i = 0; i < map.vertex_count; i++)
			sum += map.coefficient[row][i] * map.coefficient[row][i];
	return map.weight * sum / map.vertex_count;
}

// Adds omega C grad_u C / sum |grad C|^2 to `out`, for a constraint whose gradient in F is `slope`.
static void add_printed(const rig *r, int triangle, double c, double slope[3][3], double omega,
                        double *out)
{
	cau_element_map map;
	cau_tissue_element_map(&r->tissue, triangle ? CAU_ELEMENT_TRIANGLE : CAU_ELEMENT_TETRAHEDRON, 0,
	                       &map);
	double gradient[4][3] = {{0}}, size = 0;
	for (int u = 0; u < map.vertex_count; u++)
		for (int i = 0; i < 3; i++) {
			for (int row = 0; row < map.rank; row++)
				gradient[u][i] += slope[i][row] * map.coefficient[row][u];
			size += gradient[u][i] * gradient[u][i];
		}
	for (int u = 0; u < map.vertex_count; u++)
		for (int i = 0; i < 3; i++)
			out[3 * map.vertex[u] + i] += omega * c / size * gradient[u][i];
}

static void test_energy_is_equation_17(void **state)
{
	(void)state;
	const double young = 3000, poisson = 0.3;
	double mu = young / (2 * (1 + poisson)), lambda = 2 * mu * poisson / (1 - 2 * poisson);
	rig r;
	rig_begin(&r);
	cau_fat_material *material = &element_add_tetrahedron(&r)->fat[0];
	material->model = CAU_MODEL_ENERGY;
	material->young_modulus_pa = young;
	material->poisson_ratio = poisson;
	rig_build(&r, NULL, 1);
	r.solver.settings.diagonal = 1;
	uint64_t random = 51;
	for (int i = 0; i < DRAWS; i++) {
		double f[3][3], p[3][3], e[3][3], x[12], got[12], expected[12] = {0}, squares = 0;
		rig_random_gradient(&random, 0.4, f);
		element_place(&r, 0, f, x);
		rig_local(&r, x, got);
		mat_transpose_multiply(f, f, e);
		for (int k = 0; k < 9; k++) {
			e[k / 3][k % 3] = (e[k / 3][k % 3] - (k % 4 == 0)) / 2;
			squares += e[k / 3][k % 3] * e[k / 3][k % 3];
		}
		double trace = e[0][0] + e[1][1] + e[2][2];
		cau_reference_stress(CAU_MODEL_STVK, young, poisson, f, p);
		add_printed(&r, 0, mu * squares + lambda / 2 * trace * trace, p,
		            omega_of(&r, CAU_ELEMENT_TETRAHEDRON), expected);
		assert_true(rig_difference(got, expected, 12) < FORCE_TOLERANCE);
	}
	rig_finish(&r);
}

static void test_linearised_limit_is_equation_13(void **state)
{
	(void)state;
	static const double target[3] = {0.5, 0.8, 0.1};
	static const int pair[3][2] = {{0, 0}, {1, 1}, {0, 1}};
	rig r;
	rig_begin(&r);
	cau_sheet_material *material = &element_add_triangle(&r)->sheet[0];
	memcpy(material->target, target, sizeof target);
	material->projection = CAU_PROJECTION_LINEARISED;
	rig_build(&r, NULL, 1);
	r.solver.settings.diagonal = 1;
	uint64_t random = 52;
	for (int i = 0; i < DRAWS; i++) {
		double f[3][3], x[9], got[9], expected[9] = {0};
		rig_random_gradient(&random, 0.4, f);
		element_place(&r, 1, f, x);
		rig_local(&r, x, got);
		for (int c = 0; c < 3; c++) {
			int a = pair[c][0], b = pair[c][1];
			double slope[3][3] = {{0}}, k = 0;
			for (int row = 0; row < 3; row++) {
				slope[row][a] += f[row][b];
				slope[row][b] += f[row][a];
				k += f[row][a] * f[row][b];
			}
			add_printed(&r, 1, k - target[c], slope, omega_of(&r, CAU_ELEMENT_TRIANGLE), expected);
		}
		assert_true(rig_difference(got, expected, 9) < FORCE_TOLERANCE);
	}
	rig_finish(&r);
}

// A truss with C = |e| - L: each end moves half of the way.
static void test_link_goes_half_way_at_each_end(void **state)
{
	(void)state;
	static const double upper[3][3] = {{0, 0, 0.01}, {0.02, 0, 0.01}, {0, 0.02, 0.01}};
	static const double lower[3][3] = {{0.001, 0.002, 0}, {0.5, 0, 0}, {0.5, 0.3, 0}};
	static const int32_t triangle[3] = {0, 1, 2};
	rig r;
	rig_begin(&r);
	rig_add_triangles(&r, 3, upper[0], 1, triangle)->sheet[0].limit = CAU_LIMIT_NONE;
	rig_add_triangles(&r, 3, lower[0], 1, triangle)->sheet[0].limit = CAU_LIMIT_NONE;
	cau_link_material *material = &rig_add_links(&r, 0, 1, 0.011)->link;
	rig_build(&r, NULL, 1);
	assert_int_equal(r.tissue.link_count, 1);
	r.solver.settings.diagonal = 1;
	double x[18], got[18], expected[18] = {0}, e[3], length = 0;
	uint64_t random = 53;
	for (int i = 0; i < 18; i++)
		x[i] = r.tissue.rest[i] + random_between(&random, -0.003, 0.003);
	const int32_t *v = r.tissue.link;
	for (int c = 0; c < 3; c++) {
		e[c] = x[3 * v[1] + c] - x[3 * v[0] + c];
		length += e[c] * e[c];
	}
	length = sqrt(length);
	double stiffness = material->young_modulus_pa * material->area_m2 / r.tissue.link_length[0];
	for (int c = 0; c < 3; c++) {
		double force = stiffness * (length - r.tissue.link_length[0]) / 2 * e[c] / length;
		expected[3 * v[1] + c] = force;
		expected[3 * v[0] + c] = -force;
	}
	rig_local(&r, x, got);
	assert_true(rig_difference(got, expected, 18) < FORCE_TOLERANCE);
	r.solver.settings.diagonal = 0; // the system with A has the whole force
	rig_local(&r, x, got);
	for (int i = 0; i < 18; i++)
		expected[i] *= 2;
	assert_true(rig_difference(got, expected, 18) < FORCE_TOLERANCE);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_energy_is_equation_17),
		cmocka_unit_test(test_linearised_limit_is_equation_13),
		cmocka_unit_test(test_link_goes_half_way_at_each_end),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

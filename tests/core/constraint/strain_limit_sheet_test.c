// SPDX-License-Identifier: GPL-3.0-or-later
// Strain limits of triangles against the formulas of section 5.1 in plain double.
#include "base/vector.h"
#include "core/constraint/element.h"
#include "core/constraint/range.h"

enum { DRAWS = 60 };
// Largest error of a residual: about twenty roundings of numbers near one.
static const double RESIDUAL_TOLERANCE = 1e-13;
static const double TARGET[3] = {0.4, 0.9, 0.15};

static cau_sheet_material *begin(rig *r)
{
	rig_begin(r);
	return &element_add_triangle(r)->sheet[0];
}

static double weight_of(const rig *r)
{
	const cau_sheet_material *material = cau_triangle_material(&r->tissue, 0);
	return material->limit_stiffness_pa * material->thickness_m * r->tissue.triangle_area[0];
}

// Draws a random F of the triangle in its axes; the third column is perpendicular.
static void draw(uint64_t *random, double size, double f[3][3])
{
	double turn[3][3], axis[3];
	rig_random_gradient(random, size, f);
	for (int c = 0; c < 3; c++)
		axis[c] = random_between(random, -1, 1);
	mat_rotation(axis, random_between(random, -3, 3), turn);
	f[2][0] = f[2][1] = f[0][2] = f[1][2] = 0;
	f[2][2] = 1;
	mat_multiply(turn, f, f);
}

// Computes the residual R = F - P of the law, dimensionless.
static void residual(rig *r, double f[3][3], double out[3][3])
{
	element_answer(r, 1, f, out);
	for (int k = 0; k < 9; k++)
		out[k / 3][k % 3] /= weight_of(r);
}

static void metric(double f[3][3], double k[3])
{
	k[0] = k[1] = k[2] = 0;
	for (int i = 0; i < 3; i++) {
		k[0] += f[i][0] * f[i][0];
		k[1] += f[i][1] * f[i][1];
		k[2] += f[i][0] * f[i][1];
	}
}

// Checks that P = F - R has the wanted metric and is the nearest such matrix: R P^T is symmetric
// (no torque).
static void assert_projected(double f[3][3], double r[3][3], const double wanted[3])
{
	double p[3][3], k[3];
	for (int i = 0; i < 9; i++)
		p[i / 3][i % 3] = f[i / 3][i % 3] - r[i / 3][i % 3];
	metric(p, k);
	for (int i = 0; i < 3; i++)
		assert_near(k[i], wanted[i], RESIDUAL_TOLERANCE);
	for (int i = 0; i < 3; i++) {
		int a = (i + 1) % 3, b = (i + 2) % 3;
		double turn = 0;
		for (int c = 0; c < 2; c++)
			turn += r[a][c] * p[b][c] - r[b][c] * p[a][c];
		assert_near(turn, 0, RESIDUAL_TOLERANCE);
	}
}

static void test_target_is_the_polar_factor(void **state)
{
	(void)state;
	rig r;
	memcpy(begin(&r)->target, TARGET, sizeof TARGET);
	rig_build(&r, NULL, 1);
	double root3[3], root[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}};
	cau_symmetric_power2(TARGET, 0.5, 0, root3);
	root[0][0] = root3[0], root[1][1] = root3[1], root[0][1] = root[1][0] = root3[2];
	uint64_t random = 21;
	for (int i = 0; i < DRAWS; i++) {
		double f[3][3], q[3][3], p[3][3], got[3][3];
		draw(&random, 0.5, f);
		residual(&r, f, got);
		assert_projected(f, got, TARGET);
		mat_multiply(f, root, q);
		if (!(mat_determinant(f) > 0))
			// if f is reversed, the polar factor is a rotation of the sheet, not of f as drawn
			continue;
		mat_polar(q, q);
		mat_multiply(q, root, p);
		for (int k = 0; k < 9; k++)
			if (k % 3 < 2)
				assert_near(got[k / 3][k % 3], f[k / 3][k % 3] - p[k / 3][k % 3],
				            RESIDUAL_TOLERANCE);
	}
	rig_finish(&r);
}

// Checks the residual of the unordered pairs of eq. 12, each once: R = sum of C (dC/dF) /
// |dC/dF|^2, with C = f_a.f_b - t_ab.
static void test_linearised_is_equation_13(void **state)
{
	(void)state;
	rig r;
	cau_sheet_material *material = begin(&r);
	memcpy(material->target, TARGET, sizeof TARGET);
	material->projection = CAU_PROJECTION_LINEARISED;
	rig_build(&r, NULL, 1);
	static const int pair[3][2] = {{0, 0}, {1, 1}, {0, 1}};
	uint64_t random = 22;
	for (int i = 0; i < DRAWS; i++) {
		double f[3][3], got[3][3], expected[3][3] = {{0}}, k[3];
		draw(&random, 0.5, f);
		residual(&r, f, got);
		metric(f, k);
		for (int c = 0; c < 3; c++) {
			double slope[3][3] = {{0}}, size = 0;
			for (int row = 0; row < 3; row++) {
				slope[row][pair[c][0]] += f[row][pair[c][1]];
				slope[row][pair[c][1]] += f[row][pair[c][0]];
			}
			for (int e = 0; e < 9; e++)
				size += slope[e / 3][e % 3] * slope[e / 3][e % 3];
			for (int e = 0; e < 9; e++)
				expected[e / 3][e % 3] += (k[c] - TARGET[c]) / size * slope[e / 3][e % 3];
		}
		assert_near(mat_distance(got, expected), 0, RESIDUAL_TOLERANCE);
	}
	rig_finish(&r);
}

static const double LEAST[2] = {-0.1, -0.05}, MOST[2] = {0.2, 0.08}, SHEAR = 0.06;

static void begin_range(rig *r)
{
	cau_sheet_material *material = begin(r);
	material->limit = CAU_LIMIT_RANGE;
	memcpy(material->strain_min, LEAST, sizeof LEAST);
	memcpy(material->strain_max, MOST, sizeof MOST);
	material->shear_max = SHEAR;
	rig_build(r, NULL, 1);
}

static void test_range_is_the_nearest_of_each_limit(void **state)
{
	(void)state;
	static const range_limits limits = {2, LEAST, MOST, SHEAR};
	rig r;
	begin_range(&r);
	uint64_t random = 23;
	int inside = 0, outside = 0;
	for (int i = 0; i < 4 * DRAWS; i++) {
		double f[3][3], got[3][3], expected[3][3];
		draw(&random, i % 2 ? 0.4 : 0.05, f);
		residual(&r, f, got);
		if (range_residual(&limits, f, expected)) {
			inside++;
			for (int e = 0; e < 9; e++)
				assert_true(got[e / 3][e % 3] == 0);
		} else {
			outside++;
			assert_near(mat_distance(got, expected), 0, RANGE_TOLERANCE);
		}
	}
	assert_true(inside > DRAWS / 2 && outside > DRAWS);
	rig_finish(&r);
}

// If columns are parallel or zero, the nearest pair is not unique. The result must still be finite.
static void test_range_of_what_is_flat_is_finite(void **state)
{
	(void)state;
	static const double flat[][2][3] = {
		{{1, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {-1.2, 0, 0}},        {{0, 0, 0}, {0, 1, 0}},
		{{0, 0, 0}, {0, 0, 0}}, {{1e-9, 0, 0}, {1e-9, 1e-12, 0}}, {{1e6, 0, 0}, {1e6, 1, 0}}};
	rig r;
	begin_range(&r);
	for (size_t k = 0; k < sizeof flat / sizeof *flat; k++) {
		double f[3][3] = {{0}}, got[3][3], size = 0;
		for (int e = 0; e < 6; e++)
			f[e % 3][e / 3] = flat[k][e / 3][e % 3];
		residual(&r, f, got);
		for (int e = 0; e < 6; e++)
			size += fabs(flat[k][e / 3][e % 3]);
		for (int e = 0; e < 9; e++)
			// |R| is at most the distance from the set of admissible F
			if (!(fabs(got[e / 3][e % 3]) <= 1 + 2 * size))
				fail_msg("case %zu: %g", k, got[e / 3][e % 3]);
	}
	rig_finish(&r);
}

// If a sheet collapses to a line, Q is not defined. The last Q is kept.
static void test_lost_rank_keeps_the_last_rotation(void **state)
{
	(void)state;
	rig r;
	memcpy(begin(&r)->target, TARGET, sizeof TARGET);
	rig_build(&r, NULL, 1);
	double root3[3], root[3][3] = {{0}}, turn[3][3], flat[3][3] = {{0}}, got[3][3], p[3][3];
	cau_symmetric_power2(TARGET, 0.5, 0, root3);
	root[0][0] = root3[0], root[1][1] = root3[1], root[0][1] = root[1][0] = root3[2];
	mat_rotation((double[]){1, -2, 0.5}, 1.1, turn);
	residual(&r, turn, got); // F is orthonormal and T^(1/2) symmetric, so Q is F
	mat_multiply(turn, root, p);
	assert_projected(turn, got, TARGET);
	for (int pass = 0; pass < 2; pass++) { // first a line, then a point
		flat[0][0] = pass ? 0 : 0.7, flat[0][1] = pass ? 0 : 0.3;
		residual(&r, flat, got);
		for (int k = 0; k < 9; k++)
			if (k % 3 < 2)
				assert_near(got[k / 3][k % 3], flat[k / 3][k % 3] - p[k / 3][k % 3],
				            RESIDUAL_TOLERANCE);
	}
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_target_is_the_polar_factor),
		cmocka_unit_test(test_linearised_is_equation_13),
		cmocka_unit_test(test_range_is_the_nearest_of_each_limit),
		cmocka_unit_test(test_range_of_what_is_flat_is_finite),
		cmocka_unit_test(test_lost_rank_keeps_the_last_rotation),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

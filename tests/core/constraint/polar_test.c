// SPDX-License-Identifier: GPL-3.0-or-later
// The rotation nearest to F, obtained from corotated fat with Poisson's ratio 0: P = 2 mu (F - R).
// The same element gets one F after another, so every start is far from the solution.
#include "core/constraint/element.h"

enum { DRAWS = 300, RIVALS = 200 };
static const double YOUNG = 1000; // equals 2 mu, because Poisson's ratio is 0
// Largest error of an entry of R. The last Newton step leaves about epsilon, and D_m^-1 adds ten
// roundings.
static const double ROTATION_DOUBLE = 1e-12, ROTATION_SINGLE = 5e-6;

static void make(rig *r, int precision)
{
	rig_begin(r);
	r->scene->precision = precision;
	cau_fat_material *material = &element_add_tetrahedron(r)->fat[0];
	material->model = CAU_MODEL_COROTATED;
	material->young_modulus_pa = YOUNG;
	material->poisson_ratio = 0;
	rig_build(r, NULL, 1);
}

static double tolerance_of(const rig *r)
{
	return r->solver.elements.single ? ROTATION_SINGLE : ROTATION_DOUBLE;
}

static void nearest_rotation(rig *r, double f[3][3], double q[3][3])
{
	double stress[3][3];
	element_answer(r, 0, f, stress);
	for (int k = 0; k < 9; k++)
		q[k / 3][k % 3] =
			f[k / 3][k % 3] - stress[k / 3][k % 3] / (r->tissue.tetrahedron_volume[0] * YOUNG);
}

static void random_turn(uint64_t *random, double out[3][3])
{
	double axis[3];
	for (int c = 0; c < 3; c++)
		axis[c] = random_between(random, -1, 1);
	mat_rotation(axis, random_between(random, -3.1, 3.1), out);
}

// Computes F = U diag(s) V^T, with random rotations U and V.
static void with_singular_values(uint64_t *random, double a, double b, double c, double f[3][3])
{
	double u[3][3], v[3][3];
	double s[3] = {a, b, c};
	random_turn(random, u);
	random_turn(random, v);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			u[i][j] *= s[j];
	mat_multiply(u, v, f);
}

static double agreement(double q[3][3], double f[3][3])
{
	double sum = 0;
	for (int k = 0; k < 9; k++)
		sum += q[k / 3][k % 3] * f[k / 3][k % 3];
	return sum;
}

// Checks that q is a rotation, and that no other rotation agrees better with F.
static void assert_nearest(const rig *r, double f[3][3], double q[3][3], uint64_t *random)
{
	double identity[3][3], square[3][3], rival[3][3], tolerance = tolerance_of(r), size = 0;
	mat_identity(identity);
	mat_transpose_multiply(q, q, square);
	assert_near(mat_distance(square, identity), 0, 4 * tolerance);
	assert_near(mat_determinant(q), 1, 4 * tolerance);
	for (int k = 0; k < 9; k++)
		size += fabs(f[k / 3][k % 3]);
	for (int i = 0; i < RIVALS; i++) {
		random_turn(random, rival);
		assert_true(agreement(rival, f) <= agreement(q, f) + tolerance * size);
		double small[3][3], axis[3] = {0, 0, 0}; // compare with near rotations too
		axis[i % 3] = i & 1 ? 1 : -1;
		mat_rotation(axis, 0.02, small);
		mat_multiply(small, q, rival);
		assert_true(agreement(rival, f) <= agreement(q, f) + tolerance * size);
	}
}

static void test_positive_determinants(void **state)
{
	(void)state;
	for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++) {
		rig r;
		make(&r, precision);
		uint64_t random = 31;
		for (int i = 0; i < DRAWS; i++) {
			double f[3][3], q[3][3], expected[3][3];
			with_singular_values(&random, random_between(&random, 0.3, 2.5),
			                     random_between(&random, 0.3, 2.5),
			                     random_between(&random, 0.3, 2.5), f);
			nearest_rotation(&r, f, q);
			mat_polar(f, expected);
			assert_near(mat_distance(q, expected), 0, tolerance_of(&r) * 2.5 / 0.3);
		}
		rig_finish(&r);
	}
}

static void test_inverted_and_flat_elements_get_a_rotation(void **state)
{
	(void)state;
	for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++) {
		rig r;
		make(&r, precision);
		uint64_t random = 33;
		for (int i = 0; i < DRAWS; i++) {
			double f[3][3], q[3][3];
			double smallest = i % 3 ? random_between(&random, -0.4, -0.05) : 0;
			with_singular_values(&random, random_between(&random, 1.2, 2),
			                     random_between(&random, 0.6, 1), smallest, f);
			nearest_rotation(&r, f, q);
			assert_nearest(&r, f, q, &random);
		}
		rig_finish(&r);
	}
}

// Tests a mirror image of the rest shape. All singular values are equal, so every mirror axis is as
// good as any other. The result must be a rotation.
static void test_mirror_image(void **state)
{
	(void)state;
	rig r;
	make(&r, CAU_PRECISION_DOUBLE);
	uint64_t random = 34;
	double f[3][3] = {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, q[3][3];
	nearest_rotation(&r, f, q);
	assert_nearest(&r, f, q, &random);
	for (int k = 0; k < 9; k++)
		f[k / 3][k % 3] = -(k % 4 == 0);
	nearest_rotation(&r, f, q);
	assert_nearest(&r, f, q, &random);
	rig_finish(&r);
}

static void test_lost_rank_keeps_the_last_rotation(void **state)
{
	(void)state;
	rig r;
	make(&r, CAU_PRECISION_DOUBLE);
	double turn[3][3], q[3][3], line[3][3] = {{0.6, 0.8, -0.2}, {0, 0, 0}, {0, 0, 0}},
								point[3][3] = {{0}};
	mat_rotation((double[]){0.3, -1, 0.7}, 1.3, turn);
	nearest_rotation(&r, turn, q);
	assert_near(mat_distance(q, turn), 0, ROTATION_DOUBLE);
	nearest_rotation(&r, line, q);
	assert_near(mat_distance(q, turn), 0, ROTATION_DOUBLE);
	nearest_rotation(&r, point, q);
	assert_near(mat_distance(q, turn), 0, ROTATION_DOUBLE);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_positive_determinants),
		cmocka_unit_test(test_inverted_and_flat_elements_get_a_rotation),
		cmocka_unit_test(test_mirror_image),
		cmocka_unit_test(test_lost_rank_keeps_the_last_rotation),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

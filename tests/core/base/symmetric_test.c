// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of symmetric matrices against their definitions.
#include "base/vector.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/rig/matrix.h"
#include "core/tool/tools.h"

enum { DRAWS = 500 };
// Largest error, relative to the largest entry: the Jacobi iteration leaves a few roundings.
static const double TOLERANCE = 2e-14;

// Computes V diag(value) V^T, with a random rotation V.
static void random_symmetric(uint64_t *random, const double value[3], double out[6])
{
	double axis[3], v[3][3], scaled[3][3], full[3][3];
	for (int c = 0; c < 3; c++)
		axis[c] = random_between(random, -1, 1);
	mat_rotation(axis, random_between(random, -3, 3), v);
	for (int i = 0; i < 9; i++)
		scaled[i / 3][i % 3] = v[i / 3][i % 3] * value[i % 3];
	mat_transpose(v, v);
	mat_multiply(scaled, v, full);
	const double six[6] = {full[0][0], full[1][1], full[2][2], full[0][1], full[0][2], full[1][2]};
	memcpy(out, six, sizeof six);
}

static void test_eigenvectors(void **state)
{
	(void)state;
	uint64_t random = 171;
	static const double given[4][3] = {{1, 1, 1}, {2, 2, -1}, {0, 0, 3}, {1e-9, 1, 1}};
	for (int i = 0; i < DRAWS; i++) {
		double six[6], value[3], v[3][3], full[3][3], product[3][3], identity[3][3], drawn[3];
		for (int c = 0; c < 3; c++)
			drawn[c] = i < 4 ? given[i][c] : random_between(&random, -2, 2);
		random_symmetric(&random, drawn, six);
		mat_of_symmetric(six, full);
		cau_symmetric_eigen3(six, value, v);
		mat_identity(identity);
		mat_transpose_multiply(v, v, product);
		assert_near(mat_distance(product, identity), 0, TOLERANCE);
		mat_multiply(full, v, product);
		for (int k = 0; k < 9; k++)
			assert_near(product[k / 3][k % 3], value[k % 3] * v[k / 3][k % 3], 3 * TOLERANCE);
	}
}

static void test_powers(void **state)
{
	(void)state;
	uint64_t random = 172;
	for (int i = 0; i < DRAWS; i++) {
		double six[6], half[6], minus[6], drawn[3], a[3][3], root[3][3], inverse[3][3],
			product[3][3];
		double identity[3][3];
		for (int c = 0; c < 3; c++)
			drawn[c] = random_between(&random, 0.05, 2);
		random_symmetric(&random, drawn, six);
		cau_symmetric_power3(six, 0.5, 0, half);
		cau_symmetric_power3(six, -1, 0, minus);
		mat_of_symmetric(six, a);
		mat_of_symmetric(half, root);
		mat_of_symmetric(minus, inverse);
		mat_identity(identity);
		mat_multiply(root, root, product);
		assert_near(mat_distance(product, a), 0, 3 * TOLERANCE);
		mat_multiply(inverse, a, product);
		assert_near(mat_distance(product, identity), 0, 3 * TOLERANCE * 2 / 0.05);
		const double two[3] = {six[0], six[1], six[3]};
		double root2[3];
		cau_symmetric_power2(two, 0.5, 0, root2);
		assert_near(root2[0] * root2[0] + root2[2] * root2[2], two[0], 3 * TOLERANCE);
		assert_near(root2[1] * root2[1] + root2[2] * root2[2], two[1], 3 * TOLERANCE);
		assert_near((root2[0] + root2[1]) * root2[2], two[2], 3 * TOLERANCE);
		// the root is positive definite
		assert_true(root2[0] > 0 && root2[0] * root2[1] > root2[2] * root2[2]);
	}
}

static void test_floor_and_identity(void **state)
{
	(void)state;
	const double identity[6] = {1, 1, 1, 0, 0, 0}, negative[6] = {-4, 1, 9, 0, 0, 0};
	double out[6];
	cau_symmetric_power3(identity, 0.5, 0, out);
	assert_memory_equal(out, identity, sizeof out); // exact, so that forces at rest are 0
	cau_symmetric_power3(negative, 0.5, 0.25, out);
	assert_near(out[0], 0.5, TOLERANCE);
	assert_near(out[1], 1, TOLERANCE);
	assert_near(out[2], 3, TOLERANCE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_eigenvectors),
		cmocka_unit_test(test_powers),
		cmocka_unit_test(test_floor_and_identity),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

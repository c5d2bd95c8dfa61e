// SPDX-License-Identifier: GPL-3.0-or-later
// Strain limits of tetrahedra against the formulas of section 5.1 for the 3x3 metric. The limit
// acts in addition to an energy, whose known stress is subtracted.
#include "core/constraint/element.h"
#include "core/constraint/range.h"
#include "reference/stress.h"

enum { DRAWS = 60 };
// Largest error of a residual: about thirty roundings of numbers near one, and the roundings of
// D_m^-1.
static const double RESIDUAL_TOLERANCE = 1e-12;
static const double YOUNG = 100, POISSON = 0.3, LIMIT_PA = 5000;
static const double TARGET[6] = {0.4, 0.9, 1.2, 0.1, -0.06, 0.15};
static const int ROW[6] = {0, 1, 2, 0, 0, 1}, COLUMN[6] = {0, 1, 2, 1, 2, 2};

static cau_layer_def *begin(rig *r, int limit)
{
	rig_begin(r);
	cau_layer_def *layer = element_add_tetrahedron(r);
	cau_fat_material *material = &layer->fat[0];
	material->model = CAU_MODEL_STVK;
	material->young_modulus_pa = YOUNG;
	material->poisson_ratio = POISSON;
	material->limit = limit;
	material->limit_stiffness_pa = LIMIT_PA;
	return layer;
}

static void residual(rig *r, double f[3][3], double out[3][3])
{
	double known[3][3];
	element_answer(r, 0, f, out);
	cau_reference_stress(CAU_MODEL_STVK, YOUNG, POISSON, f, known);
	for (int k = 0; k < 9; k++)
		out[k / 3][k % 3] =
			(out[k / 3][k % 3] / r->tissue.tetrahedron_volume[0] - known[k / 3][k % 3]) / LIMIT_PA;
}

// Checks that P = F - R has the wanted metric, is not inverted, and that R P^T is symmetric (no
// torque).
static void assert_projected(double f[3][3], double r[3][3], double wanted[3][3])
{
	double p[3][3], k[3][3], turned[3][3], turn[3][3];
	for (int i = 0; i < 9; i++)
		p[i / 3][i % 3] = f[i / 3][i % 3] - r[i / 3][i % 3];
	mat_transpose_multiply(p, p, k);
	assert_near(mat_distance(k, wanted), 0, RESIDUAL_TOLERANCE);
	assert_true(mat_determinant(p) > 0);
	mat_transpose(p, turn);
	mat_multiply(r, turn, turn);
	mat_transpose(turn, turned);
	assert_near(mat_distance(turn, turned), 0, RESIDUAL_TOLERANCE);
}

static void test_target_is_the_nearest_of_its_metric(void **state)
{
	(void)state;
	rig r;
	memcpy(begin(&r, CAU_LIMIT_TARGET)->fat[0].target, TARGET, sizeof TARGET);
	rig_build(&r, NULL, 1);
	double wanted[3][3];
	mat_of_symmetric(TARGET, wanted);
	uint64_t random = 41;
	int inverted = 0;
	for (int i = 0; i < 3 * DRAWS; i++) {
		double f[3][3], got[3][3];
		rig_random_gradient(&random, 0.9, f);
		inverted += mat_determinant(f) < 0;
		residual(&r, f, got);
		assert_projected(f, got, wanted);
	}
	assert_true(inverted > 5);
	rig_finish(&r);
}

// The first material axis is the fibre direction: T = I + (t_00 - 1) a a^T.
static void test_target_follows_the_fibre(void **state)
{
	(void)state;
	static const double FIBRE[3] = {0.48, -0.6, 0.64}; // has length 1
	rig r;
	cau_layer_def *layer = begin(&r, CAU_LIMIT_TARGET);
	memcpy(layer->fibre, FIBRE, sizeof FIBRE);
	layer->fat[0].target[0] = 0.3;
	rig_build(&r, NULL, 1);
	double wanted[3][3], f[3][3], got[3][3];
	uint64_t random = 42;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			wanted[i][j] = (i == j) + (0.3 - 1) * FIBRE[i] * FIBRE[j];
	rig_random_gradient(&random, 0.3, f);
	residual(&r, f, got);
	assert_projected(f, got, wanted);
	rig_finish(&r);
}

static void test_linearised_is_equation_13(void **state)
{
	(void)state;
	rig r;
	cau_fat_material *material = &begin(&r, CAU_LIMIT_TARGET)->fat[0];
	memcpy(material->target, TARGET, sizeof TARGET);
	material->projection = CAU_PROJECTION_LINEARISED;
	rig_build(&r, NULL, 1);
	uint64_t random = 43;
	for (int i = 0; i < DRAWS; i++) {
		double f[3][3], got[3][3], k[3][3], expected[3][3] = {{0}};
		rig_random_gradient(&random, 0.6, f);
		residual(&r, f, got);
		mat_transpose_multiply(f, f, k);
		for (int p = 0; p < 6; p++) {
			double slope[3][3] = {{0}}, size = 0;
			for (int row = 0; row < 3; row++) {
				slope[row][ROW[p]] += f[row][COLUMN[p]];
				slope[row][COLUMN[p]] += f[row][ROW[p]];
			}
			for (int e = 0; e < 9; e++)
				size += slope[e / 3][e % 3] * slope[e / 3][e % 3];
			for (int e = 0; e < 9; e++)
				expected[e / 3][e % 3] +=
					(k[ROW[p]][COLUMN[p]] - TARGET[p]) / size * slope[e / 3][e % 3];
		}
		assert_near(mat_distance(got, expected), 0, RESIDUAL_TOLERANCE);
	}
	rig_finish(&r);
}

static const double LEAST[3] = {-0.1, -0.05, -0.2}, MOST[3] = {0.2, 0.08, 0.1}, SHEAR = 0.06;

static void test_range_is_the_nearest_of_each_limit(void **state)
{
	(void)state;
	static const range_limits limits = {3, LEAST, MOST, SHEAR};
	rig r;
	cau_fat_material *material = &begin(&r, CAU_LIMIT_RANGE)->fat[0];
	memcpy(material->strain_min, LEAST, sizeof LEAST);
	memcpy(material->strain_max, MOST, sizeof MOST);
	material->shear_max = SHEAR;
	rig_build(&r, NULL, 1);
	uint64_t random = 44;
	int inside = 0, outside = 0;
	for (int i = 0; i < 6 * DRAWS; i++) {
		double f[3][3], got[3][3], expected[3][3];
		rig_random_gradient(&random, i % 2 ? 0.4 : 0.04, f);
		residual(&r, f, got);
		// the tolerance is the rounding of the known stress
		if (range_residual(&limits, f, expected)) {
			inside++;
			assert_near(mat_distance(got, expected), 0, RESIDUAL_TOLERANCE);
		} else {
			outside++;
			assert_near(mat_distance(got, expected), 0, RANGE_TOLERANCE);
		}
	}
	assert_true(inside > DRAWS / 3 && outside > DRAWS);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_target_is_the_nearest_of_its_metric),
		cmocka_unit_test(test_target_follows_the_fibre),
		cmocka_unit_test(test_linearised_is_equation_13),
		cmocka_unit_test(test_range_is_the_nearest_of_each_limit),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

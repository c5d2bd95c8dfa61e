// SPDX-License-Identifier: GPL-3.0-or-later
// The energies of fat against closed forms, and against a stress that the test computes.
#include "constraint/elements.h"
#include "core/constraint/element.h"
#include "reference/stress.h"
#include "reference/uniaxial.h"

enum { CAPACITY = 64, DRAWS = 40 };

// Largest errors of a stress, relative to E. The reference values in uniaxial.txt have 15 digits.
// D_m^-1 of this tetrahedron adds about ten rounding errors. A stress is a difference of terms as
// large as E.
static const double UNIAXIAL_TOLERANCE = 1e-11;
static const double STRESS_TOLERANCE = 1e-11;
// Largest relative error of Psi from the stress, by Simpson's rule over 200 parts of a straight
// path. The rule has the relative error h^4 / 180.
static const double WORK_TOLERANCE = 1e-7;

static void make(rig *r, int model, double young, double poisson)
{
	rig_begin(r);
	cau_fat_material *material = &element_add_tetrahedron(r)->fat[0];
	material->model = model;
	material->young_modulus_pa = young;
	material->poisson_ratio = poisson;
	rig_build(r, NULL, 1);
}

static void test_uniaxial_stretch(void **state)
{
	(void)state;
	cau_reference_uniaxial rows[CAPACITY];
	int32_t count = 0;
	cau_error error = {0};
	assert_int_equal(cau_reference_uniaxial_read(CAU_TEST_REFERENCE "/uniaxial.txt", CAPACITY, rows,
	                                             &count, &error),
	                 CAU_OK);
	assert_true(count > 0);
	for (int32_t i = 0; i < count; i++) {
		const cau_reference_uniaxial *row = &rows[i];
		rig r;
		make(&r, row->model, row->young_modulus_pa, row->poisson_ratio);
		double l = row->lateral_stretch, f[3][3] = {{row->stretch, 0, 0}, {0, l, 0}, {0, 0, l}};
		double stress[3][3], expected[3][3] = {{row->stress_pa, 0, 0}, {0, 0, 0}, {0, 0, 0}};
		element_answer(&r, 0, f, stress);
		double volume = r.tissue.tetrahedron_volume[0];
		for (int k = 0; k < 9; k++)
			assert_near(stress[k / 3][k % 3] / volume, expected[k / 3][k % 3],
			            UNIAXIAL_TOLERANCE * row->young_modulus_pa);
		rig_finish(&r);
	}
}

static void test_stress_by_hand(void **state)
{
	(void)state;
	static const int models[] = {CAU_MODEL_STVK, CAU_MODEL_NEOHOOKEAN};
	const double young = 4000, poisson = 0.41;
	uint64_t random = 3;
	for (int m = 0; m < 2; m++) {
		rig r;
		make(&r, models[m], young, poisson);
		double volume = r.tissue.tetrahedron_volume[0];
		for (int i = 0; i < DRAWS; i++) {
			double f[3][3], stress[3][3], expected[3][3];
			rig_random_gradient(&random, 0.8, f); // some of these f are inverted
			element_answer(&r, 0, f, stress);
			cau_reference_stress(models[m], young, poisson, f, expected);
			for (int k = 0; k < 9; k++)
				assert_near(stress[k / 3][k % 3] / volume, expected[k / 3][k % 3],
				            STRESS_TOLERANCE * young);
		}
		rig_finish(&r);
	}
}

// Checks P = 2 mu (F - R) + lambda tr(R^T F - I) R, with R by plain averaging.
static void test_corotated_by_hand(void **state)
{
	(void)state;
	const double young = 4000, poisson = 0.35;
	double mu = young / (2 * (1 + poisson)), lambda = 2 * mu * poisson / (1 - 2 * poisson);
	uint64_t random = 3;
	rig r;
	make(&r, CAU_MODEL_COROTATED, young, poisson);
	for (int i = 0; i < DRAWS; i++) {
		double f[3][3], q[3][3], stress[3][3], trace = -3;
		rig_random_gradient(&random, 0.4, f);
		element_answer(&r, 0, f, stress);
		mat_polar(f, q);
		for (int k = 0; k < 9; k++)
			trace += q[k / 3][k % 3] * f[k / 3][k % 3];
		for (int k = 0; k < 9; k++) {
			double rotation = q[k / 3][k % 3];
			double expected = 2 * mu * (f[k / 3][k % 3] - rotation) + lambda * trace * rotation;
			assert_near(stress[k / 3][k % 3] / r.tissue.tetrahedron_volume[0], expected,
			            STRESS_TOLERANCE * young);
		}
	}
	rig_finish(&r);
}

// The energy at F = I + H is the work of the stress along I + s H, for any H.
static void test_energy_is_the_work_done(void **state)
{
	(void)state;
	enum { PARTS = 200 };
	for (int model = 0; model < CAU_MODEL_COUNT; model++) {
		const cau_law *law = cau_law_of(model);
		if (!law->has_energy)
			continue;
		rig r;
		make(&r, model, 4000, fmin(0.4, law->poisson_most));
		uint64_t random = 17;
		double h[3][3], f[3][3], stress[3][3], x[12], work = 0;
		rig_random_gradient(&random, 0.5, h);
		for (int p = 0; p <= PARTS; p++) {
			double s = (double)p / PARTS, weight = p % PARTS == 0 ? 1 : p % 2 ? 4 : 2, power = 0;
			for (int k = 0; k < 9; k++)
				f[k / 3][k % 3] = (k % 4 == 0) + s * (h[k / 3][k % 3] - (k % 4 == 0));
			element_answer(&r, 0, f, stress);
			for (int k = 0; k < 9; k++)
				power += stress[k / 3][k % 3] * (h[k / 3][k % 3] - (k % 4 == 0));
			work += weight * power / (3 * PARTS);
		}
		element_place(&r, 0, h, x);
		double energy = rig_local(&r, x, NULL);
		assert_true(energy > 0);
		assert_near(energy, work, WORK_TOLERANCE * work);
		rig_finish(&r);
	}
}

// Checks the printed energy constraint: dF = -Psi P / |P|^2 with the St. Venant-Kirchhoff energy.
// The weight is (2 mu + 3 lambda) times the volume.
static void test_energy_constraint_by_hand(void **state)
{
	(void)state;
	const double young = 4000, poisson = 0.3;
	double mu = young / (2 * (1 + poisson)), lambda = 2 * mu * poisson / (1 - 2 * poisson);
	uint64_t random = 9;
	rig r;
	make(&r, CAU_MODEL_ENERGY, young, poisson);
	for (int i = 0; i < DRAWS; i++) {
		double f[3][3], e[3][3], p[3][3], stress[3][3], squares = 0, trace = 0, size = 0;
		rig_random_gradient(&random, 0.5, f);
		mat_transpose_multiply(f, f, e);
		for (int k = 0; k < 9; k++) {
			e[k / 3][k % 3] = (e[k / 3][k % 3] - (k % 4 == 0)) / 2;
			squares += e[k / 3][k % 3] * e[k / 3][k % 3];
		}
		trace = e[0][0] + e[1][1] + e[2][2];
		double psi = mu * squares + lambda / 2 * trace * trace;
		cau_reference_stress(CAU_MODEL_STVK, young, poisson, f, p);
		for (int k = 0; k < 9; k++)
			size += p[k / 3][k % 3] * p[k / 3][k % 3];
		element_answer(&r, 0, f, stress);
		for (int k = 0; k < 9; k++) {
			double expected = (2 * mu + 3 * lambda) * psi / size * p[k / 3][k % 3];
			assert_near(stress[k / 3][k % 3] / r.tissue.tetrahedron_volume[0], expected,
			            STRESS_TOLERANCE * young);
		}
	}
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_uniaxial_stretch),
		cmocka_unit_test(test_stress_by_hand),
		cmocka_unit_test(test_corotated_by_hand),
		cmocka_unit_test(test_energy_is_the_work_done),
		cmocka_unit_test(test_energy_constraint_by_hand),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

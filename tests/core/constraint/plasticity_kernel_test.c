// SPDX-License-Identifier: GPL-3.0-or-later
// Plastic flow against the rule in plain double. Let e' be the deviator of the elastic strain, and
// d = |e'| - gamma_1. If d > 0, e_p grows by (d / |e'|) e' and is scaled back to gamma_2 if it is
// longer.
#include "core/constraint/element.h"

static const double YIELD = 0.03, MOST = 0.16;
// Largest error of strains below one: ten roundings, and an inverse square root.
static const double STRAIN_TOLERANCE = 1e-12;

static void make(rig *r, double yield, double most)
{
	rig_begin(r);
	cau_fat_material *material = &element_add_tetrahedron(r)->fat[0];
	material->yield_strain = yield;
	material->plastic_strain_max = most;
	rig_build(r, NULL, 1);
}

static int32_t settle(rig *r, double f[3][3])
{
	double x[12];
	element_place(r, 0, f, x);
	rig_local(r, x, NULL);
	int32_t inverted = 0;
	for (int32_t w = 0; w < r->solver.slots.work_count; w++)
		inverted += r->solver.kernels->settle(&r->solver.elements, &r->solver.slots.work[w],
		                                      r->solver.iterate.displacement);
	return inverted;
}

static void stored(const rig *r, void *const array[6], int32_t slot, double out[3][3])
{
	double s[6];
	for (int i = 0; i < 6; i++)
		s[i] = cau_real_get(array[i], r->solver.elements.single, slot);
	mat_of_symmetric(s, out);
}

static double norm(double a[3][3])
{
	double sum = 0;
	for (int k = 0; k < 9; k++)
		sum += a[k / 3][k % 3] * a[k / 3][k % 3];
	return sqrt(sum);
}

// Computes e_p after one tick at F, from e_p before and the map z = C_p^(-1/2) - I.
static void flow(double f[3][3], double map[3][3], double plastic[3][3], double yield, double most)
{
	double fe[3][3], e[3][3], z[3][3];
	mat_identity(z);
	for (int k = 0; k < 9; k++)
		z[k / 3][k % 3] += map[k / 3][k % 3];
	mat_multiply(f, z, fe);
	mat_transpose_multiply(fe, fe, e);
	double trace = e[0][0] + e[1][1] + e[2][2];
	for (int k = 0; k < 9; k++)
		e[k / 3][k % 3] = (e[k / 3][k % 3] - (k % 4 == 0 ? trace / 3 : 0)) / 2;
	double beyond = norm(e) - yield;
	if (beyond <= 0)
		return;
	double step = beyond / norm(e);
	for (int k = 0; k < 9; k++)
		plastic[k / 3][k % 3] += step * e[k / 3][k % 3];
	double length = norm(plastic);
	for (int k = 0; k < 9 && length > most; k++)
		plastic[k / 3][k % 3] *= most / length;
}

// Checks (I + z) (I + 2 e_p) (I + z) = I for every slot. The maps z are computed two vectors at a
// time.
static void expect_maps(const rig *r, double tolerance)
{
	double identity[3][3];
	mat_identity(identity);
	for (int32_t slot = 0; slot < r->solver.elements.fat.slot_count; slot++) {
		double c[3][3], z[3][3], product[3][3];
		stored(r, r->solver.elements.fat.plastic, slot, z);
		stored(r, r->solver.elements.fat.plastic_strain, slot, c);
		for (int k = 0; k < 9; k++) {
			c[k / 3][k % 3] = (k % 4 == 0) + 2 * c[k / 3][k % 3];
			z[k / 3][k % 3] += k % 4 == 0;
		}
		mat_multiply(z, c, product);
		mat_multiply(product, z, product);
		assert_near(mat_distance(product, identity), 0, tolerance);
	}
}

static void test_flow_by_hand(void **state)
{
	(void)state;
	rig r;
	make(&r, YIELD, MOST);
	uint64_t random = 61;
	double plastic[3][3] = {{0}};
	int flowed = 0, capped = 0;
	for (int tick = 0; tick < 60; tick++) {
		double f[3][3], map[3][3], got[3][3], before = norm(plastic);
		rig_random_gradient(&random, tick % 3 ? 0.25 : 0.01, f);
		stored(&r, r.solver.elements.fat.plastic, 0, map);
		flow(f, map, plastic, YIELD, MOST);
		settle(&r, f);
		stored(&r, r.solver.elements.fat.plastic_strain, 0, got);
		assert_near(mat_distance(got, plastic), 0, STRAIN_TOLERANCE);
		flowed += norm(plastic) != before;
		capped += norm(plastic) > MOST * (1 - 1e-9);
		assert_true(norm(plastic) <= MOST * (1 + 1e-9));
		expect_maps(&r, STRAIN_TOLERANCE);
		memcpy(plastic, got, sizeof got);
	}
	assert_true(flowed > 20 && capped > 5);
	rig_finish(&r);
}

static void test_below_yield_nothing_flows(void **state)
{
	(void)state;
	rig r;
	make(&r, YIELD, MOST);
	double strain = 0.9 * YIELD / sqrt(1.5), got[3][3], none[3][3] = {{0}};
	// a stretch and the contraction of its sides: the deviator's norm is sqrt(1.5) times the strain
	double f[3][3] = {
		{sqrt(1 + 2 * strain), 0, 0}, {0, sqrt(1 - strain), 0}, {0, 0, sqrt(1 - strain)}};
	settle(&r, f);
	stored(&r, r.solver.elements.fat.plastic_strain, 0, got);
	assert_true(mat_distance(got, none) == 0);
	rig_finish(&r);
}

// Plastic flow makes the deformed shape the new rest shape. If a stretch is held for long, only the
// yield stress remains, here 0.
static void test_flow_takes_the_stress_away(void **state)
{
	(void)state;
	rig r;
	make(&r, 0, 0.4);
	double f[3][3] = {{1.15, 0, 0}, {0, 1 / sqrt(1.15), 0}, {0, 0, 1 / sqrt(1.15)}};
	double first[3][3], last[3][3];
	element_answer(&r, 0, f, first);
	for (int tick = 0; tick < 60; tick++)
		settle(&r, f);
	element_answer(&r, 0, f, last);
	double mean = (last[0][0] * f[0][0] + last[1][1] * f[1][1] + last[2][2] * f[2][2]) / 3;
	// the deviator of P F^T; the remainder is pressure
	double deviator = last[0][0] * f[0][0] - mean;
	assert_true(fabs(deviator) < 1e-6 * norm(first));
	rig_finish(&r);
}

// A block in every precision and on every instruction set has the same plastic strains.
static void test_precisions_and_instruction_sets_agree(void **state)
{
	(void)state;
	static const char *const tiers[] = {"baseline", "avx2", "avx512"};
	// largest error of strains of a tenth, computed as differences of squares near one, over three
	// ticks
	static const double tolerance[] = {3e-5, 1e-13};
	double expected[6 * 128] = {0};
	for (int precision = CAU_PRECISION_COUNT - 1; precision >= 0; precision--)
		for (int t = 0; t < 3; t++) {
			rig r;
			rig_begin(&r);
			r.scene->precision = precision;
			cau_fat_material *material = &rig_add_slab(&r, 3, 3, 2)->fat[0];
			material->yield_strain = YIELD;
			material->plastic_strain_max = MOST;
			rig_build(&r, tiers[t], 1);
			uint64_t random = 62;
			double a[3][3], got[6 * 128] = {0};
			for (int tick = 0; tick < 3; tick++) {
				rig_random_gradient(&random, 0.1, a);
				rig_deform(&r, a, 1e-3, &random, r.solver.position);
				rig_local(&r, r.solver.position, NULL);
				for (int32_t w = 0; w < r.solver.slots.work_count; w++)
					r.solver.kernels->settle(&r.solver.elements, &r.solver.slots.work[w],
					                         r.solver.iterate.displacement);
			}
			// the tolerance is a hundred roundings of numbers near one
			expect_maps(&r, r.solver.elements.single ? 6e-6 : STRAIN_TOLERANCE);
			for (int i = 0; i < 6; i++)
				for (int32_t s = 0; s < r.tissue.tetrahedron_count; s++)
					got[128 * i + s] = cau_real_get(r.solver.elements.fat.plastic_strain[i],
					                                r.solver.elements.single, s);
			if (precision == CAU_PRECISION_DOUBLE && !t)
				memcpy(expected, got, sizeof got);
			assert_true(rig_difference(got, expected, 6 * 128) < tolerance[precision]);
			rig_finish(&r);
		}
	double most = 0;
	for (int i = 0; i < 6 * 128; i++)
		most = fmax(most, fabs(expected[i]));
	assert_true(most > 0.01);
}

static void test_inverted_are_counted(void **state)
{
	(void)state;
	rig r;
	make(&r, YIELD, MOST);
	double f[3][3] = {{-0.5, 0, 0}, {0, 1, 0}, {0, 0, 1}}, identity[3][3];
	mat_identity(identity);
	assert_int_equal(settle(&r, identity), 0);
	assert_int_equal(settle(&r, f), 1);
	rig_remove(&r, CAU_ELEMENT_TETRAHEDRON, 0, 0);
	assert_int_equal(settle(&r, f), 0);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_flow_by_hand),
		cmocka_unit_test(test_below_yield_nothing_flows),
		cmocka_unit_test(test_flow_takes_the_stress_away),
		cmocka_unit_test(test_precisions_and_instruction_sets_agree),
		cmocka_unit_test(test_inverted_are_counted),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

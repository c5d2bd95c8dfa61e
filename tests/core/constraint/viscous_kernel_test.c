// SPDX-License-Identifier: GPL-3.0-or-later
// Viscosity against a stress that the test computes, and its potential against the work of that
// stress.
#include "core/constraint/element.h"

enum { DRAWS = 40 };

static const double viscosity_s = 0.004, young_pa = 4000, poisson = 0.41, sheet_pa = 2e4;
// Largest error of a stress, relative to the largest stress: about ten roundings of D_m^-1, as in
// fat_energy_test.c.
static const double TOLERANCE = 1e-11;
// Largest relative error of work, by Simpson's rule over 200 parts of a straight path. The rule is
// exact for powers up to three, and the stress has no higher powers.
static const double WORK_TOLERANCE = 1e-10;

static void make(rig *r, int triangle)
{
	rig_begin(r);
	cau_layer_def *layer = triangle ? element_add_triangle(r) : element_add_tetrahedron(r);
	layer->viscosity_s = viscosity_s;
	layer->fat[0].young_modulus_pa = young_pa;
	layer->fat[0].poisson_ratio = poisson;
	layer->sheet[0].limit_stiffness_pa = sheet_pa;
	rig_build(r, NULL, 1);
}

static void strain_of(double f[3][3], double e[3][3])
{
	mat_transpose_multiply(f, f, e);
	for (int k = 0; k < 9; k++)
		e[k / 3][k % 3] = (e[k / 3][k % 3] - (k % 4 == 0)) / 2;
}

// Sets R to the strain at f, or moves R by `share` of the way to it.
static void take_strain(rig *r, int triangle, double f[3][3], double share)
{
	element_place(r, triangle, f, r->solver.position);
	cau_solver_take_strain(&r->solver, share);
}

// Computes viscosity's part of the element's stress times volume at f, and its potential in
// *potential_j.
static void viscous_answer(rig *r, int triangle, double f[3][3], double stress[3][3],
                           double *potential_j)
{
	double law[3][3];
	element_answer(r, triangle, f, stress);
	*potential_j = cau_solver_viscous_energy(&r->solver);
	double rate = r->solver.elements.rate_per_s;
	r->solver.elements.rate_per_s = 0;
	element_answer(r, triangle, f, law);
	r->solver.elements.rate_per_s = rate;
	for (int k = 0; k < 9; k++)
		stress[k / 3][k % 3] -= law[k / 3][k % 3];
}

// Computes F C : (E - R) t / h, times volume. For a triangle E and R have two axes.
static void expected_stress(const rig *r, int triangle, double f[3][3], double from[3][3],
                            double out[3][3])
{
	double e[3][3], trace = 0, mu = young_pa / (2 * (1 + poisson));
	double lambda = 2 * mu * poisson / (1 - 2 * poisson), rate = viscosity_s / r->solver.inertia_s;
	strain_of(f, e);
	for (int k = 0; k < 9; k++)
		e[k / 3][k % 3] -= from[k / 3][k % 3];
	for (int k = 0; k < 3; k++)
		trace += e[k][k];
	for (int k = 0; k < 9; k++) {
		double fat = 2 * mu * e[k / 3][k % 3] + (k % 4 == 0 ? lambda * trace : 0);
		double sheet = k / 3 < 2 && k % 3 < 2 ? sheet_pa * e[k / 3][k % 3] : 0;
		double volume = triangle
		                    ? r->tissue.triangle_area[0] * r->scene->layers[0].sheet[0].thickness_m
		                    : r->tissue.tetrahedron_volume[0];
		e[k / 3][k % 3] = volume * rate * (triangle ? sheet : fat);
	}
	mat_multiply(f, e, out);
}

static void check_stress(int triangle)
{
	uint64_t random = 5;
	rig r;
	make(&r, triangle);
	for (int i = 0; i < DRAWS; i++) {
		double a[3][3], b[3][3], f[3][3], from[3][3], to[3][3], stress[3][3], expected[3][3];
		double potential_j;
		rig_random_gradient(&random, 0.4, a);
		rig_random_gradient(&random, 0.4, b);
		rig_random_gradient(&random, 0.4, f);
		take_strain(&r, triangle, a, 1);
		take_strain(&r, triangle, b, 2.4); // a share above 1, as in a second substep
		strain_of(a, from);
		strain_of(b, to);
		for (int k = 0; k < 9; k++)
			from[k / 3][k % 3] += 2.4 * (to[k / 3][k % 3] - from[k / 3][k % 3]);
		viscous_answer(&r, triangle, f, stress, &potential_j);
		expected_stress(&r, triangle, f, from, expected);
		assert_true(rig_difference(stress[0], expected[0], 9) <= TOLERANCE);
	}
	rig_finish(&r);
}

static void test_stress_by_hand(void **state)
{
	(void)state;
	check_stress(0);
	check_stress(1);
}

// Along F = F_0 + s H, the potential grows by the work of the stress.
static void check_work(int triangle)
{
	enum { PARTS = 200 };
	uint64_t random = 17;
	rig r;
	make(&r, triangle);
	double f0[3][3], f1[3][3], f[3][3], stress[3][3], from_j, to_j = 0, work = 0;
	rig_random_gradient(&random, 0.3, f0);
	rig_random_gradient(&random, 0.3, f1);
	take_strain(&r, triangle, f0, 1);
	viscous_answer(&r, triangle, f0, stress, &from_j);
	assert_near(from_j, 0, 1e-30);
	for (int p = 0; p <= PARTS; p++) {
		double s = (double)p / PARTS, weight = p % PARTS == 0 ? 1 : p % 2 ? 4 : 2, power = 0;
		for (int k = 0; k < 9; k++)
			f[k / 3][k % 3] = f0[k / 3][k % 3] + s * (f1[k / 3][k % 3] - f0[k / 3][k % 3]);
		viscous_answer(&r, triangle, f, stress, &to_j);
		for (int k = 0; k < 9; k++)
			power += stress[k / 3][k % 3] * (f1[k / 3][k % 3] - f0[k / 3][k % 3]);
		work += weight * power / (3 * PARTS);
	}
	assert_true(to_j > 0);
	assert_near(to_j, work, WORK_TOLERANCE * work);
	rig_finish(&r);
}

static void test_potential_is_the_work_done(void **state)
{
	(void)state;
	check_work(0);
	check_work(1);
}

// If an element has only rotated since R was taken, its stress is 0 up to rounding. The rounding is
// relative to the stress of an R that is taken at rest.
static void test_turning_is_not_damped(void **state)
{
	(void)state;
	for (int triangle = 0; triangle < 2; triangle++) {
		uint64_t random = 3;
		double rest[3][3], f[3][3], turn[3][3], turned[3][3], stress[3][3], size[3][3], potential_j;
		rig r;
		make(&r, triangle);
		mat_identity(rest);
		rig_random_gradient(&random, 0.3, f);
		mat_rotation((double[3]){0.48, 0.6, 0.64}, 1.1, turn);
		mat_multiply(turn, f, turned);
		take_strain(&r, triangle, rest, 1);
		viscous_answer(&r, triangle, turned, size, &potential_j);
		take_strain(&r, triangle, f, 1);
		viscous_answer(&r, triangle, turned, stress, &potential_j);
		double most = 0;
		for (int k = 0; k < 9; k++)
			most = fmax(most, fabs(size[k / 3][k % 3]));
		for (int k = 0; k < 9; k++)
			assert_near(stress[k / 3][k % 3], 0, TOLERANCE * most);
		rig_finish(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_stress_by_hand),
		cmocka_unit_test(test_potential_is_the_work_done),
		cmocka_unit_test(test_turning_is_not_damped),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Trusses and hinges against formulas: a spring along e, and bending that turns with the sheet.
#include <string.h>

#include "core/constraint/element.h"
#include "core/rig/law_scenes.h"

// Largest relative error of a link's force: a dozen roundings, enlarged because the change of
// length is a small difference of two lengths.
static const double FORCE_TOLERANCE = 1e-11;

static void test_links_are_springs(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	law_scenes[12].add(&r);
	rig_build(&r, NULL, 1);
	assert_true(r.tissue.link_count > 10);
	uint64_t random = 181;
	double a[3][3], *x = r.solver.position, expected_energy = 0;
	rig_random_gradient(&random, 0.3, a);
	rig_deform(&r, a, 2e-3, &random, x);
	rig_local(&r, x, NULL);
	double energy = rig_energy_of(&r, CAU_ELEMENT_LINK);
	for (int32_t k = 0; k < r.tissue.link_count; k++) {
		const int32_t *v = r.tissue.link + 2 * k;
		cau_vec3 along = cau_sub(cau_vec3_of(x + 3 * v[1]), cau_vec3_of(x + 3 * v[0]));
		double length = cau_length(along), longer = length - r.tissue.link_length[k], got[6];
		const cau_link_material *material = &r.tissue.layer[r.tissue.link_layer[k]].def.link;
		double w = material->young_modulus_pa * material->area_m2 / r.tissue.link_length[k];
		cau_vec3 force = cau_scale(w * longer / length, along);
		const double expected[6] = {-force.x, -force.y, -force.z, force.x, force.y, force.z};
		expected_energy += w * longer * longer / 2;
		rig_element_gradient(&r, CAU_ELEMENT_LINK, k, got);
		assert_true(rig_difference(got, expected, 6) < FORCE_TOLERANCE);
	}
	assert_near(energy, expected_energy, FORCE_TOLERANCE * expected_energy);
	rig_finish(&r);
}

// A truss of length 0 has no direction. Its force must still be a number.
static void test_a_link_of_no_length(void **state)
{
	(void)state;
	for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++) {
		rig r;
		rig_begin(&r);
		r.scene->precision = precision;
		law_scenes[12].add(&r);
		rig_build(&r, NULL, 1);
		double *gradient =
			cau_arena_array(&r.arena, 3 * (size_t)r.tissue.vertex_count, sizeof(double));
		const int32_t *v = r.tissue.link;
		memcpy(r.solver.position + 3 * v[0], r.solver.position + 3 * v[1], 3 * sizeof(double));
		assert_true(isfinite(rig_local(&r, r.solver.position, gradient)));
		for (int32_t i = 0; i < 3 * r.tissue.vertex_count; i++)
			assert_true(isfinite(gradient[i]));
		rig_finish(&r);
	}
}

// A flat sheet's hinge has the energy w/2 |e|^2, and a bent sheet's hinge w/2 (|e| - |rest|)^2. A
// rotation of the whole sheet changes neither energy.
static void test_hinges_keep_their_bend(void **state)
{
	(void)state;
	for (int flat = 0; flat < 2; flat++) {
		rig r;
		rig_begin(&r);
		if (flat)
			rig_add_sheet(&r, 3, 3)->sheet[0].bending_stiffness_nm = 0.01;
		else
			law_add_roof(&r);
		r.scene->layers[0].sheet[0].limit = CAU_LIMIT_NONE;
		rig_build(&r, NULL, 1);
		uint64_t random = 182;
		double a[3][3], *x = r.solver.position, expected = 0;
		mat_rotation((double[]){1, -1, 2}, 2.1, a);
		rig_deform(&r, a, 0, &random, x);
		double turned = rig_local(&r, x, NULL);
		rig_random_gradient(&random, 0.2, a);
		rig_deform(&r, a, 2e-3, &random, x);
		double bent = rig_local(&r, x, NULL);
		for (int32_t h = 0; h < r.tissue.hinge_count; h++) {
			double now[3] = {0}, rest[3] = {0};
			for (int i = 0; i < 4; i++)
				for (int c = 0; c < 3; c++) {
					double k = r.tissue.hinge_coefficient[4 * h + i];
					int32_t at = 3 * r.tissue.hinge_vertex[4 * h + i] + c;
					now[c] += k * x[at];
					rest[c] += k * r.tissue.rest[at];
				}
			double more = cau_length(cau_vec3_of(now)) - cau_length(cau_vec3_of(rest));
			expected += r.tissue.hinge_weight[h] * more * more / 2;
		}
		assert_true(bent > 0);
		assert_near(rig_energy_of(&r, CAU_ELEMENT_HINGE), expected, 1e-10 * expected);
		assert_true(turned < 1e-20 * bent + 1e-22);
		rig_finish(&r);
	}
}

// In the diagonal system a hinge is one constraint C = |e| - |rest|. It moves each vertex by -C c_i
// / |c|^2 along e, weighted with omega = w |c|^2 / 4.
static void test_hinges_in_the_diagonal_system(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	law_add_roof(&r)->sheet[0].limit = CAU_LIMIT_NONE;
	rig_build(&r, NULL, 1);
	r.solver.settings.diagonal = 1;
	uint64_t random = 183;
	double a[3][3], *x = r.solver.position;
	rig_random_gradient(&random, 0.2, a);
	rig_deform(&r, a, 2e-3, &random, x);
	rig_local(&r, x, NULL);
	for (int32_t h = 0; h < r.tissue.hinge_count; h++) {
		const double *k = r.tissue.hinge_coefficient + 4 * h;
		double e[3] = {0}, rest[3] = {0}, squares = 0, got[12], expected[12];
		for (int i = 0; i < 4; i++) {
			squares += k[i] * k[i];
			for (int c = 0; c < 3; c++) {
				e[c] += k[i] * x[3 * r.tissue.hinge_vertex[4 * h + i] + c];
				rest[c] += k[i] * r.tissue.rest[3 * r.tissue.hinge_vertex[4 * h + i] + c];
			}
		}
		double length = cau_length(cau_vec3_of(e));
		double more = length - cau_length(cau_vec3_of(rest));
		double omega = r.tissue.hinge_weight[h] * squares / 4;
		for (int i = 0; i < 12; i++)
			expected[i] = omega * more * k[i / 3] / squares * e[i % 3] / length;
		rig_element_gradient(&r, CAU_ELEMENT_HINGE, h, got);
		assert_true(rig_difference(got, expected, 12) < FORCE_TOLERANCE);
	}
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_links_are_springs),
		cmocka_unit_test(test_a_link_of_no_length),
		cmocka_unit_test(test_hinges_keep_their_bend),
		cmocka_unit_test(test_hinges_in_the_diagonal_system),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

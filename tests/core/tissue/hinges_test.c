// SPDX-License-Identifier: GPL-3.0-or-later
// Bending coefficients: no bending on a flat patch in any orientation, and the cotangent Laplacian
// on a bent patch.
#include <string.h>

#include "core/rig/law_scenes.h"

// Rounding of cotangents of well-shaped triangles, times metres. The tests allow ten times this
// value.
static const double FLAT_TOLERANCE = 1e-15;

static void combine(const rig *r, int32_t hinge, const double *x, double e[3])
{
	for (int c = 0; c < 3; c++) {
		e[c] = 0;
		for (int i = 0; i < 4; i++)
			e[c] += r->tissue.hinge_coefficient[4 * hinge + i] *
			        x[3 * r->tissue.hinge_vertex[4 * hinge + i] + c];
	}
}

static void test_flat_patches_do_not_bend(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	rig_add_sheet(&r, 5, 4)->sheet[0].bending_stiffness_nm = 0.01;
	rig_build(&r, NULL, 1);
	// The grid has inner edges of 3 kinds.
	assert_int_equal(r.tissue.hinge_count, 5 * 4 + 4 * 4 + 5 * 3);
	enum { VERTICES = 6 * 5 };
	assert_int_equal(r.tissue.vertex_count, VERTICES);
	double turn[3][3], x[3 * VERTICES] = {0}, e[3], gradient[3 * VERTICES];
	mat_rotation((double[]){1, 2, -1}, 0.8, turn);
	for (int32_t v = 0; v < r.tissue.vertex_count; v++)
		mat_apply(turn, r.tissue.rest + 3 * v, x + 3 * v);
	for (int32_t h = 0; h < r.tissue.hinge_count; h++)
		for (int turned = 0; turned < 2; turned++) {
			combine(&r, h, turned ? x : r.tissue.rest, e);
			for (int c = 0; c < 3; c++)
				assert_near(e[c], 0, FLAT_TOLERANCE * 10);
		}
	// A stretch within the plane is not bending.
	for (int32_t i = 0; i < 3 * r.tissue.vertex_count; i++)
		x[i] *= 1.3;
	rig_local(&r, x, gradient);
	assert_true(rig_energy_of(&r, CAU_ELEMENT_HINGE) < 1e-25);
	rig_finish(&r);
}

// e is the sum of the edge's cotangents. For two triangles at the edge a-b, e is |ab| times the sum
// of two unit vectors. Each vector is in the plane of its triangle, normal to the edge, and points
// inward.
static void test_bent_patches_by_hand(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	law_add_roof(&r);
	rig_build(&r, NULL, 1);
	assert_int_equal(r.tissue.hinge_count, 3);
	for (int32_t h = 0; h < 3; h++) {
		const int32_t *v = r.tissue.hinge_vertex + 4 * h;
		cau_vec3 a = cau_vec3_of(r.tissue.rest + 3 * v[0]);
		cau_vec3 along = cau_sub(cau_vec3_of(r.tissue.rest + 3 * v[1]), a), sum = {0, 0, 0};
		double length = cau_length(along), e[3], area = 0;
		along = cau_scale(1 / length, along);
		for (int k = 0; k < 2; k++) {
			cau_vec3 up = cau_sub(cau_vec3_of(r.tissue.rest + 3 * v[2 + k]), a);
			up = cau_add_scaled(up, -cau_dot(up, along), along);
			area += cau_length(up) * length / 2;
			sum = cau_add_scaled(sum, -length / cau_length(up), up);
		}
		combine(&r, h, r.tissue.rest, e);
		assert_near(e[0], sum.x, FLAT_TOLERANCE * 10);
		assert_near(e[1], sum.y, FLAT_TOLERANCE * 10);
		assert_near(e[2], sum.z, FLAT_TOLERANCE * 10);
		double expected = 3 * 0.02 / area; // three times the bending stiffness over the area
		assert_near(r.tissue.hinge_weight[h], expected, 1e-12 * expected);
	}
	rig_finish(&r);
}

static void test_no_stiffness_no_hinges(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	rig_add_sheet(&r, 3, 3);
	rig_build(&r, NULL, 1);
	assert_int_equal(r.tissue.hinge_count, 0);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_flat_patches_do_not_bend),
		cmocka_unit_test(test_bent_patches_by_hand),
		cmocka_unit_test(test_no_stiffness_no_hinges),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

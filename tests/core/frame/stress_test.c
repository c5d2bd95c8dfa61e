// SPDX-License-Identifier: GPL-3.0-or-later
// The stress channel against closed forms for uniform strain.
#include <string.h>

#include "core/rig/rig.h"
#include "frame/frame_state.h"

// Largest relative error of a stress: rounding of float sums over two dozen tetrahedra.
static const double STRESS_TOLERANCE = 1e-5;

typedef struct framed {
	rig r;
	cau_frame_state frame;
} framed;

static void make(framed *f)
{
	memset(f, 0, sizeof *f);
	rig_begin(&f->r);
	rig_add_slab(&f->r, 3, 2, 2);
	rig_build(&f->r, NULL, 1);
	assert_int_equal(cau_frame_create(&f->frame, &f->r.tissue, &f->r.dissection, &f->r.arena, NULL),
	                 CAU_OK);
}

// Returns the von Mises stress at the uniform deformation gradient F. Returns 0 if a vertex of
// living fat has another stress than the others.
static double uniform_stress(framed *f, double map[3][3])
{
	uint64_t random = 1;
	rig_deform(&f->r, map, 0, &random, f->r.solver.position);
	cau_frame_stress(&f->frame, &f->r.tissue, &f->r.dissection, f->r.solver.position);
	double first = (double)f->frame.stress[0];
	for (int32_t v = 0; v < f->r.tissue.vertex_count; v++)
		assert_near((double)f->frame.stress[v], first, STRESS_TOLERANCE * first + 1e-9);
	return first;
}

static void test_closed_forms(void **state)
{
	(void)state;
	framed f;
	make(&f);
	double lambda, mu, e = 0.02, s = 0.1;
	cau_fat_lame(&f.r.tissue.layer[0].def.fat[0], &lambda, &mu);
	// Green strain e along one axis only gives 2 mu e.
	double stretch[3][3] = {{sqrt(1 + 2 * e), 0, 0}, {0, 1, 0}, {0, 0, 1}};
	assert_near(uniform_stress(&f, stretch), 2 * mu * e, STRESS_TOLERANCE * 2 * mu * e);
	// Equal stretch in all directions, and a rotation, give no stress.
	double grow[3][3] = {{1.2, 0, 0}, {0, 1.2, 0}, {0, 0, 1.2}}, turn[3][3];
	mat_rotation((double[]){1, 2, 3}, 1, turn);
	assert_near(uniform_stress(&f, grow), 0, STRESS_TOLERANCE * mu);
	assert_near(uniform_stress(&f, turn), 0, STRESS_TOLERANCE * mu);
	// Simple shear s: E_01 = s/2, E_11 = s^2/2.
	double shear[3][3] = {{1, s, 0}, {0, 1, 0}, {0, 0, 1}};
	double expected = 2 * mu * sqrt(s * s * s * s / 4 + 3 * s * s / 4);
	assert_near(uniform_stress(&f, shear), expected, STRESS_TOLERANCE * expected);
	rig_finish(&f.r);
}

static void test_removed_fat_has_none(void **state)
{
	(void)state;
	framed f;
	make(&f);
	double stretch[3][3] = {{1.1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	uniform_stress(&f, stretch);
	memset(f.r.dissection.alive.element[CAU_ELEMENT_TETRAHEDRON], 0,
	       (size_t)f.r.tissue.tetrahedron_count);
	cau_frame_stress(&f.frame, &f.r.tissue, &f.r.dissection, f.r.solver.position);
	for (int32_t v = 0; v < f.r.tissue.vertex_count; v++)
		assert_true(f.frame.stress[v] == 0);
	rig_finish(&f.r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_closed_forms),
		cmocka_unit_test(test_removed_fat_has_none),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

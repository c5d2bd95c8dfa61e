// SPDX-License-Identifier: GPL-3.0-or-later
// Targets and materials are set again: removed elements stay removed, shrunk elements keep their
// targets.
#include <string.h>

#include "core/dissect/cutting.h"

static void make(rig *r, int precision)
{
	rig_begin(r);
	r->scene->precision = precision;
	add_all_layers(r);
	rig_build(r, NULL, 1);
}

static double weight_of(const rig *r, int kind, int32_t slot)
{
	const cau_elements *e = &r->solver.elements;
	void *const weights[] = {e->sheet.weight, e->fat.volume, e->link.weight, e->hinge.weight};
	return cau_real_get(weights[kind], e->single, slot);
}

static void test_targets_are_set_and_read(void **state)
{
	(void)state;
	// all six values are exact in float
	const double root[6] = {0.5, 0.75, 0.25, 0.125, -0.0625, 0.03125};
	for (int precision = 0; precision < CAU_PRECISION_COUNT; precision++) {
		rig r;
		make(&r, precision);
		double got[6];
		cau_elements *e = &r.solver.elements;
		int32_t slot = r.solver.slots.slot_of[CAU_ELEMENT_TETRAHEDRON][9];
		assert_true(cau_real_get(e->fat.limit_weight, e->single, slot) == 0);
		for (int kind = 0; kind <= CAU_ELEMENT_TETRAHEDRON; kind++) {
			cau_elements_set_target(e, &r.solver.slots, &r.tissue, kind, 9, root);
			cau_elements_target(e, &r.solver.slots, kind, 9, got);
			for (int i = 0; i < (kind ? 6 : 3); i++)
				assert_true(got[i] == root[i]);
		}
		// once its target is set, fat without a limit has a limit
		double expected =
			r.tissue.tetrahedron_volume[9] * r.tissue.layer[0].def.fat[0].limit_stiffness_pa;
		assert_near(cau_real_get(e->fat.limit_weight, e->single, slot), expected, 1e-7 * expected);
		assert_int_equal(e->fat.limited[slot / CAU_BATCH], 1);
		for (int32_t b = 0; b < e->fat.slot_count / CAU_BATCH; b++)
			assert_int_equal(e->fat.targeted[b], b == slot / CAU_BATCH);
		// the marks are the same if they are computed after the restore of a snapshot
		cau_elements_mark_targets(e, &r.solver.slots);
		for (int32_t b = 0; b < e->fat.slot_count / CAU_BATCH; b++)
			assert_int_equal(e->fat.targeted[b], b == slot / CAU_BATCH);
		rig_finish(&r);
	}
}

// New materials reach live elements only. Removed elements stay removed, and shrunk elements keep
// their targets.
static void test_new_materials(void **state)
{
	(void)state;
	rig r;
	make(&r, CAU_PRECISION_DOUBLE);
	cau_step_solver *s = &r.solver;
	const double root[6] = {0.5, 0.5, 0.5, 0, 0, 0};
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		rig_remove(&r, kind, 3, 0);
	cau_elements_set_target(&s->elements, &s->slots, &r.tissue, CAU_ELEMENT_TRIANGLE, 4, root);
	r.shrink.shrunk[CAU_ELEMENT_TRIANGLE][4] = 1;
	double before = weight_of(&r, CAU_ELEMENT_TRIANGLE, s->slots.slot_of[CAU_ELEMENT_TRIANGLE][4]);
	r.tissue.layer[1].def.sheet[0].limit_stiffness_pa *= 2;
	r.tissue.layer[1].def.sheet[0].target[0] = 0.81;
	r.tissue.layer[0].def.fat[0].young_modulus_pa *= 3;
	cau_elements_set_materials(&s->elements, &s->slots, &r.tissue, r.dissection.alive.element,
	                           r.shrink.shrunk);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		assert_true(weight_of(&r, kind, s->slots.slot_of[kind][3]) == 0);
	double after = weight_of(&r, CAU_ELEMENT_TRIANGLE, s->slots.slot_of[CAU_ELEMENT_TRIANGLE][4]);
	assert_near(after, 2 * before, 1e-15 * before);
	double got[6];
	cau_elements_target(&s->elements, &s->slots, CAU_ELEMENT_TRIANGLE, 4, got);
	assert_true(got[0] == 0.5);
	cau_elements_target(&s->elements, &s->slots, CAU_ELEMENT_TRIANGLE, 5, got);
	assert_near(got[0], 0.9, 1e-15);
	double lambda, mu;
	cau_fat_lame(&r.tissue.layer[0].def.fat[0], &lambda, &mu);
	assert_near(s->elements.fat.group[0].stiffness, 2 * mu + 3 * lambda, 1e-9);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_targets_are_set_and_read),
		cmocka_unit_test(test_new_materials),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

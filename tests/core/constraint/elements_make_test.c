// SPDX-License-Identifier: GPL-3.0-or-later
// Slots: every element has one, and padding has no effect.
#include <string.h>

#include "core/dissect/cutting.h"

static void make(rig *r, int precision)
{
	rig_begin(r);
	r->scene->precision = precision;
	add_all_layers(r);
	rig_build(r, NULL, 1);
}

static int32_t slot_count(const cau_elements *e, int kind)
{
	const int32_t counts[] = {e->sheet.slot_count, e->fat.slot_count, e->link.slot_count,
	                          e->hinge.slot_count};
	return counts[kind];
}

static double weight_of(const rig *r, int kind, int32_t slot)
{
	const cau_elements *e = &r->solver.elements;
	void *const weights[] = {e->sheet.weight, e->fat.volume, e->link.weight, e->hinge.weight};
	return cau_real_get(weights[kind], e->single, slot);
}

static void test_slots_and_elements_are_one_to_one(void **state)
{
	(void)state;
	rig r;
	make(&r, CAU_PRECISION_SINGLE);
	const cau_element_slots *slots = &r.solver.slots;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++) {
		int32_t filled = 0, count = cau_tissue_element_count(&r.tissue, kind);
		assert_true(count > 0);
		assert_int_equal(slot_count(&r.solver.elements, kind) % CAU_BATCH, 0);
		for (int32_t s = 0; s < slot_count(&r.solver.elements, kind); s++) {
			int32_t element = slots->element_at[kind][s];
			if (element < 0) {
				assert_true(weight_of(&r, kind, s) == 0);
				continue;
			}
			filled++;
			assert_int_equal(slots->slot_of[kind][element], s);
			assert_true(weight_of(&r, kind, s) > 0);
		}
		assert_int_equal(filled, count);
	}
	rig_finish(&r);
}

// The second element of a pair is one batch after the first. The kernel reads the shared vertices
// from the first.
static void test_pairs_share_all_but_their_apex(void **state)
{
	(void)state;
	static const int kinds[] = {CAU_ELEMENT_TRIANGLE, CAU_ELEMENT_TETRAHEDRON};
	rig r;
	make(&r, CAU_PRECISION_SINGLE);
	const cau_elements *e = &r.solver.elements;
	for (int k = 0; k < 2; k++) {
		const int32_t *element_at = r.solver.slots.element_at[kinds[k]];
		int apex = k ? 3 : 2;
		assert_int_equal(slot_count(e, kinds[k]) % (2 * CAU_BATCH), 0);
		for (int32_t s = 0; s < slot_count(e, kinds[k]); s++) {
			if (s % (2 * CAU_BATCH) >= CAU_BATCH || element_at[s + CAU_BATCH] < 0)
				continue;
			assert_true(element_at[s] >= 0); // an element without a partner is in the first batch
			for (int i = 0; i < apex; i++) {
				assert_int_equal(rig_vertex(&r, kinds[k], s, i),
				                 rig_vertex(&r, kinds[k], s + CAU_BATCH, i));
				assert_int_equal(rig_record(&r, kinds[k], s, i),
				                 rig_record(&r, kinds[k], s + CAU_BATCH, i));
			}
			assert_int_not_equal(rig_vertex(&r, kinds[k], s, apex),
			                     rig_vertex(&r, kinds[k], s + CAU_BATCH, apex));
		}
	}
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_slots_and_elements_are_one_to_one),
		cmocka_unit_test(test_pairs_share_all_but_their_apex),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

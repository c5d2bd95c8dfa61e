// SPDX-License-Identifier: GPL-3.0-or-later
// Tests records and shares of work: each record belongs to one vertex, and each batch to one share.
#include <string.h>

#include "core/dissect/cutting.h"

static void make(rig *r, int precision)
{
	rig_begin(r);
	r->scene->precision = precision;
	add_all_layers(r);
	rig_build(r, NULL, 1);
}

// Each vertex of an element has a record. The record belongs to that vertex, and the vertex sums it
// once. A record that no vertex sums belongs to no element.
static void test_every_record_is_summed_once(void **state)
{
	(void)state;
	rig r;
	make(&r, CAU_PRECISION_DOUBLE);
	const cau_elements *e = &r.solver.elements;
	const cau_incidence *incidence = &r.solver.slots.incidence;
	int32_t *vertex_of = cau_arena_array(&r.arena, (size_t)e->record_count, sizeof(int32_t));
	uint8_t *used = cau_arena_array(&r.arena, (size_t)e->record_count, 1);
	memset(vertex_of, -1, (size_t)e->record_count * sizeof(int32_t));
	for (int32_t v = 0; v < r.tissue.vertex_count; v++)
		for (int32_t k = incidence->first[v]; k < incidence->first[v + 1]; k++) {
			assert_true(k == incidence->first[v] ||
			            incidence->record[k] > incidence->record[k - 1]);
			assert_int_equal(vertex_of[incidence->record[k]], -1);
			vertex_of[incidence->record[k]] = v;
		}
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t i = 0; i < cau_tissue_element_count(&r.tissue, kind); i++) {
			cau_element_map map;
			cau_tissue_element_map(&r.tissue, kind, i, &map);
			int32_t slot = r.solver.slots.slot_of[kind][i], found = 0;
			for (int k = 0; k < map.vertex_count; k++) {
				int32_t record = rig_record(&r, kind, slot, k);
				// the pair may have another order of vertices
				for (int own = 0; own < map.vertex_count; own++)
					if (vertex_of[record] == map.vertex[own])
						found |= 1 << own;
				assert_int_equal(4 * vertex_of[record], e->record_vertex[record]);
				used[record] = 1;
			}
			assert_int_equal(found, (1 << map.vertex_count) - 1);
		}
	for (int32_t k = 0; k < e->record_count; k++)
		assert_int_equal(used[k], vertex_of[k] >= 0);
	rig_finish(&r);
}

// A share writes only the records of its own range, and the ranges do not overlap.
static void test_shares_write_apart(void **state)
{
	(void)state;
	rig r;
	make(&r, CAU_PRECISION_DOUBLE);
	const cau_elements *e = &r.solver.elements;
	int32_t next = 0;
	for (int32_t w = 0; w < r.solver.slots.work_count; w++) {
		const cau_local_work *work = &r.solver.slots.work[w];
		assert_int_equal(work->first_record, next);
		next += work->record_count;
		for (int32_t s = work->first; s < work->last; s++) // the loop includes padding
			for (int i = 0; i < rig_vertex_count(work->kind); i++) {
				int32_t record = rig_record(&r, work->kind, s, i);
				assert_true(record >= work->first_record && record < next);
			}
	}
	assert_int_equal(next, e->record_count);
	rig_finish(&r);
}

// The shares of the local step cover every batch of every set once. A share has elements of one
// group.
static void test_work_covers_everything_once(void **state)
{
	(void)state;
	rig r;
	make(&r, CAU_PRECISION_DOUBLE);
	const cau_elements *e = &r.solver.elements;
	int32_t covered[4] = {0};
	uint8_t seen[4][4096] = {{0}};
	for (int32_t w = 0; w < r.solver.slots.work_count; w++) {
		const cau_local_work *work = &r.solver.slots.work[w];
		assert_int_equal(work->first % CAU_BATCH, 0);
		assert_int_equal(work->last % CAU_BATCH, 0);
		covered[work->kind] += work->last - work->first;
		for (int32_t s = work->first; s < work->last; s += CAU_BATCH)
			assert_int_equal(seen[work->kind][s / CAU_BATCH]++, 0);
		if (work->kind == CAU_ELEMENT_TETRAHEDRON) {
			const cau_fat_group *group = &e->fat.group[work->group];
			assert_true(work->first >= group->first_slot &&
			            work->last <= group->first_slot + group->slot_count);
		} else if (work->kind == CAU_ELEMENT_TRIANGLE) {
			const cau_sheet_group *group = &e->sheet.group[work->group];
			assert_true(work->first >= group->first_slot &&
			            work->last <= group->first_slot + group->slot_count);
		}
	}
	assert_int_equal(covered[CAU_ELEMENT_TRIANGLE], e->sheet.slot_count);
	assert_int_equal(covered[CAU_ELEMENT_TETRAHEDRON], e->fat.slot_count);
	assert_int_equal(covered[CAU_ELEMENT_LINK], e->link.slot_count);
	assert_int_equal(covered[CAU_ELEMENT_HINGE], e->hinge.slot_count);
	assert_int_equal(e->sheet.group_count, 2); // membrane and fascia have separate laws
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_every_record_is_summed_once),
		cmocka_unit_test(test_shares_write_apart),
		cmocka_unit_test(test_work_covers_everything_once),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

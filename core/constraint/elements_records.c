// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient records, the local step's shares, and which records each vertex sums.
#include "constraint/elements_internal.h"

enum { WORK_BATCHES = 16 }; // batches in one share of the local step

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the gradient records");
}

static void add_work(cau_element_slots *slots, int kind, int32_t group, int32_t first, int32_t last)
{
	for (int32_t at = first; at < last; at += WORK_BATCHES * CAU_BATCH) {
		int32_t end = at + WORK_BATCHES * CAU_BATCH;
		slots->work[slots->work_count++] =
			(cau_local_work){kind, group, at, end < last ? end : last};
	}
}

cau_status cau_elements_make_work(const cau_elements *elements, cau_element_slots *slots,
                                  cau_arena *arena, cau_error *error)
{
	int32_t share = WORK_BATCHES * CAU_BATCH;
	int32_t most = elements->batch_count * CAU_BATCH / share + elements->sheet.group_count +
	               elements->fat.group_count + 2;
	slots->work = cau_arena_array(arena, (size_t)most, sizeof *slots->work);
	if (!slots->work)
		return no_memory(error);
	for (int32_t g = 0; g < elements->fat.group_count; ++g) {
		const cau_fat_group *group = &elements->fat.group[g];
		add_work(slots, CAU_WORK_FAT, g, group->first_slot, group->first_slot + group->slot_count);
	}
	for (int32_t g = 0; g < elements->sheet.group_count; ++g) {
		const cau_sheet_group *group = &elements->sheet.group[g];
		add_work(slots, CAU_WORK_SHEET, g, group->first_slot,
		         group->first_slot + group->slot_count);
	}
	add_work(slots, CAU_WORK_LINK, 0, 0, elements->link.slot_count);
	add_work(slots, CAU_WORK_HINGE, 0, 0, elements->hinge.slot_count);
	return CAU_OK;
}

// Calls visit(context, vertex, record) for every record of a real element, sheets, fat, links,
// hinges.
typedef struct record_range {
	int32_t *const *vertex;
	const int32_t *element_at;
	int32_t vertices, slots;
	int64_t record;
} record_range;

static void ranges_of(const cau_elements *elements, const cau_element_slots *slots,
                      record_range range[CAU_ELEMENT_KINDS])
{
	range[CAU_ELEMENT_TRIANGLE] =
		(record_range){elements->sheet.vertex, slots->element_at[CAU_ELEMENT_TRIANGLE], 3,
	                   elements->sheet.slot_count, elements->sheet_record};
	range[CAU_ELEMENT_TETRAHEDRON] =
		(record_range){elements->fat.vertex, slots->element_at[CAU_ELEMENT_TETRAHEDRON], 4,
	                   elements->fat.slot_count, elements->fat_record};
	range[CAU_ELEMENT_LINK] =
		(record_range){elements->link.vertex, slots->element_at[CAU_ELEMENT_LINK], 2,
	                   elements->link.slot_count, elements->link_record};
	range[CAU_ELEMENT_HINGE] =
		(record_range){elements->hinge.vertex, slots->element_at[CAU_ELEMENT_HINGE], 4,
	                   elements->hinge.slot_count, elements->hinge_record};
}

cau_status cau_elements_make_incidence(const cau_tissue *tissue, const cau_elements *elements,
                                       cau_element_slots *slots, cau_arena *arena, cau_error *error)
{
	cau_incidence *incidence = &slots->incidence;
	record_range range[CAU_ELEMENT_KINDS];
	ranges_of(elements, slots, range);
	size_t n = (size_t)tissue->vertex_count;
	incidence->first = cau_arena_array(arena, n + 2, sizeof(int32_t));
	incidence->record = cau_arena_array(arena, (size_t)elements->record_count, sizeof(int32_t));
	if (!incidence->first || !incidence->record)
		return no_memory(error);
	int32_t *place = incidence->first + 1; // counts, then cursors, in place
	for (int pass = 0; pass < 2; ++pass) {
		for (int kind = 0; kind < CAU_ELEMENT_KINDS; ++kind)
			for (int32_t s = 0; s < range[kind].slots; ++s)
				for (int i = 0; i < range[kind].vertices && range[kind].element_at[s] >= 0; ++i) {
					int32_t v = range[kind].vertex[i][s];
					if (!pass)
						place[v + 1]++;
					else
						incidence->record[place[v]++] =
							(int32_t)(range[kind].record + (int64_t)range[kind].vertices * s + i);
				}
		for (int32_t v = 0; !pass && v < tissue->vertex_count; ++v)
			place[v + 1] += place[v];
	}
	return CAU_OK;
}

cau_status cau_elements_make_records(cau_elements *elements, cau_arena *arena, cau_error *error)
{
	int64_t records = 0;
	elements->sheet_record = records;
	records += 3 * (int64_t)elements->sheet.slot_count;
	elements->fat_record = records;
	records += 4 * (int64_t)elements->fat.slot_count;
	elements->link_record = records;
	records += 2 * (int64_t)elements->link.slot_count;
	elements->hinge_record = records;
	records += 4 * (int64_t)elements->hinge.slot_count;
	elements->record_count = records;
	int32_t batches = 0;
	elements->sheet_batch = batches;
	batches += elements->sheet.slot_count / CAU_BATCH;
	elements->fat_batch = batches;
	batches += elements->fat.slot_count / CAU_BATCH;
	elements->link_batch = batches;
	batches += elements->link.slot_count / CAU_BATCH;
	elements->hinge_batch = batches;
	batches += elements->hinge.slot_count / CAU_BATCH;
	elements->batch_count = batches;
	elements->gradient =
		cau_arena_array(arena, 4 * (size_t)records, cau_real_bytes(elements->single));
	elements->energy = cau_arena_array(arena, (size_t)batches, sizeof(double));
	return elements->gradient && elements->energy && records < INT32_MAX ? CAU_OK
	                                                                     : no_memory(error);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The local step's shares, the records they write, and which records each vertex sums.
#include <string.h>

#include "constraint/elements_internal.h"

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the gradient records");
}

static void add_work(cau_element_slots *slots, int kind, int32_t group, int32_t first, int32_t last)
{
	for (int32_t at = first; at < last; at += CAU_SHARE) {
		int32_t end = at + CAU_SHARE, number = slots->work_count++;
		slots->work[number] = (cau_local_work){.number = number,
		                                       .kind = kind,
		                                       .group = group,
		                                       .first = at,
		                                       .last = end < last ? end : last};
	}
}

cau_status cau_elements_make_work(cau_elements *elements, cau_element_slots *slots,
                                  cau_arena *arena, cau_error *error)
{
	int32_t slot_count = elements->sheet.slot_count + elements->fat.slot_count +
	                     elements->link.slot_count + elements->hinge.slot_count;
	int32_t most =
		slot_count / CAU_SHARE + elements->sheet.group_count + elements->fat.group_count + 2;
	slots->work = cau_arena_array(arena, (size_t)most, sizeof *slots->work);
	elements->energy = cau_arena_array(arena, (size_t)most, sizeof *elements->energy);
	if (!slots->work || !elements->energy)
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

// ---- records
typedef struct share_elements {
	int32_t *const *vertex_at, *const *record_at;
	const int32_t *element_at;
	int32_t vertices;
} share_elements;

static share_elements elements_of(const cau_elements *elements, const cau_element_slots *slots,
                                  const cau_local_work *work)
{
	switch (work->kind) {
	case CAU_WORK_SHEET:
		return (share_elements){elements->sheet.vertex_at, elements->sheet.record_at,
		                        slots->element_at[CAU_ELEMENT_TRIANGLE], 3};
	case CAU_WORK_FAT:
		return (share_elements){elements->fat.vertex_at, elements->fat.record_at,
		                        slots->element_at[CAU_ELEMENT_TETRAHEDRON], 4};
	case CAU_WORK_LINK:
		return (share_elements){elements->link.vertex_at, elements->link.record_at,
		                        slots->element_at[CAU_ELEMENT_LINK], 2};
	default:
		return (share_elements){elements->hinge.vertex_at, elements->hinge.record_at,
		                        slots->element_at[CAU_ELEMENT_HINGE], 4};
	}
}

// Numbers the share's records from `next` on, a vertex each as they come; `last_record` (by vertex)
// holds the last record that each vertex got. The first belongs to padding and to no vertex.
static int32_t number_records(const share_elements *share, cau_local_work *work, int32_t next,
                              int32_t *last_record)
{
	work->first_record = next++;
	for (int32_t s = work->first; s < work->last; ++s)
		for (int i = 0; i < share->vertices; ++i) {
			int32_t *last = &last_record[share->vertex_at[i][s] / 4];
			if (share->element_at[s] < 0) {
				share->record_at[i][s] = 4 * work->first_record;
				continue;
			}
			if (*last < work->first_record)
				*last = next++;
			share->record_at[i][s] = 4 * *last;
		}
	work->record_count = next - work->first_record;
	return next;
}

// Lists for each vertex its records: counts first, then cursors, in place.
static cau_status list_records(const cau_tissue *tissue, const cau_elements *elements,
                               cau_element_slots *slots, cau_arena *arena, int32_t *last_record)
{
	cau_incidence *incidence = &slots->incidence;
	size_t n = (size_t)tissue->vertex_count;
	incidence->first = cau_arena_array(arena, n + 2, sizeof(int32_t));
	incidence->record = cau_arena_array(arena, (size_t)elements->record_count, sizeof(int32_t));
	if (!incidence->first || !incidence->record)
		return CAU_NO_MEMORY;
	int32_t *place = incidence->first + 1;
	for (int pass = 0; pass < 2; ++pass) {
		memset(last_record, -1, n * sizeof *last_record);
		for (int32_t w = 0; w < slots->work_count; ++w) {
			const cau_local_work *work = &slots->work[w];
			share_elements share = elements_of(elements, slots, work);
			for (int32_t s = work->first; s < work->last; ++s)
				for (int i = 0; i < share.vertices && share.element_at[s] >= 0; ++i) {
					int32_t v = share.vertex_at[i][s] / 4, record = share.record_at[i][s] / 4;
					if (last_record[v] == record)
						continue;
					last_record[v] = record;
					if (!pass)
						place[v + 1]++;
					else
						incidence->record[place[v]++] = record;
				}
		}
		for (int32_t v = 0; !pass && v < tissue->vertex_count; ++v)
			place[v + 1] += place[v];
	}
	return CAU_OK;
}

cau_status cau_elements_make_records(const cau_tissue *tissue, cau_elements *elements,
                                     cau_element_slots *slots, cau_arena *arena, cau_error *error)
{
	cau_arena scratch = {0};
	size_t n = (size_t)tissue->vertex_count;
	int32_t *last_record = cau_arena_array(&scratch, n, sizeof *last_record);
	cau_status status = last_record ? CAU_OK : CAU_NO_MEMORY;
	if (!status) {
		memset(last_record, -1, n * sizeof *last_record);
		for (int32_t w = 0; w < slots->work_count; ++w) {
			share_elements share = elements_of(elements, slots, &slots->work[w]);
			elements->record_count =
				number_records(&share, &slots->work[w], elements->record_count, last_record);
		}
		elements->gradient = cau_arena_array(arena, 4 * (size_t)elements->record_count,
		                                     cau_real_bytes(elements->single));
		status = elements->gradient ? list_records(tissue, elements, slots, arena, last_record)
		                            : CAU_NO_MEMORY;
	}
	cau_arena_finish(&scratch);
	return status ? no_memory(error) : CAU_OK;
}

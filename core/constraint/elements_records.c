// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the shares of the local step, their records, and the list of records that each vertex sums.
#include <string.h>

#include "cautery/assert.h"
#include "constraint/elements_internal.h"

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the gradient records");
}

static void add_work(cau_element_slots *slots, int kind, int32_t group, int32_t first, int32_t last)
{
	CAU_ASSERT(first <= last && (last - first) % CAU_BATCH == 0, "slots %d to %d", first, last);
	for (int32_t at = first; at < last; at += CAU_SHARE) {
		int32_t end = at + CAU_SHARE, number = slots->work_count++;
		slots->work[number] = (cau_local_work){.number = number,
		                                       .kind = kind,
		                                       .group = group,
		                                       .first = at,
		                                       .last = end < last ? end : last};
	}
}

cau_status cau_elements_make_work(const cau_tissue *tissue, cau_elements *elements,
                                  cau_element_slots *slots, cau_arena *arena, cau_error *error)
{
	int32_t slot_count = elements->sheet.slot_count + elements->fat.slot_count +
	                     elements->link.slot_count + elements->hinge.slot_count;
	int32_t most =
		slot_count / CAU_SHARE + elements->sheet.group_count + elements->fat.group_count + 2;
	slots->work = cau_arena_array(arena, (size_t)most, sizeof *slots->work);
	elements->energy = cau_arena_array(arena, (size_t)most, sizeof *elements->energy);
	elements->slack = cau_arena_array(arena, (size_t)most, sizeof *elements->slack);
	if (tissue->viscous)
		elements->viscous_j = cau_arena_array(arena, (size_t)most, sizeof *elements->viscous_j);
	if (!slots->work || !elements->energy || !elements->slack ||
	    (tissue->viscous && !elements->viscous_j))
		return no_memory(error);
	for (int32_t g = 0; g < elements->fat.group_count; g++) {
		const cau_fat_group *group = &elements->fat.group[g];
		add_work(slots, CAU_ELEMENT_TETRAHEDRON, g, group->first_slot,
		         group->first_slot + group->slot_count);
	}
	for (int32_t g = 0; g < elements->sheet.group_count; g++) {
		const cau_sheet_group *group = &elements->sheet.group[g];
		add_work(slots, CAU_ELEMENT_TRIANGLE, g, group->first_slot,
		         group->first_slot + group->slot_count);
	}
	add_work(slots, CAU_ELEMENT_LINK, 0, 0, elements->link.slot_count);
	add_work(slots, CAU_ELEMENT_HINGE, 0, 0, elements->hinge.slot_count);
	CAU_ASSERT(slots->work_count <= most, "%d shares, and room for %d", slots->work_count, most);
	return CAU_OK;
}

// ---- records
typedef struct share_elements {
	uint16_t *const *record_at;
	int32_t *const *vertex_at; // vertex of each slot
	const int32_t *element_at;
	int vertices;
} share_elements;

static share_elements elements_of(const cau_elements *elements, const cau_element_slots *slots,
                                  const cau_slot_vertices *vertices, int kind)
{
	CAU_ASSERT_INDEX(kind, CAU_ELEMENT_KINDS);
	uint16_t *const *record_at[] = {elements->sheet.record_at, elements->fat.record_at,
	                                elements->link.record_at, elements->hinge.record_at};
	static const int count[] = {3, 4, 2, 4};
	return (share_elements){record_at[kind], vertices->at[kind], slots->element_at[kind],
	                        count[kind]};
}

// Numbers the share's records from `next` on, one for each vertex in the order of first use.
// `last_record` (by vertex) is the last record of each vertex. The share's first record is for
// padding and belongs to no vertex. Returns the next free number.
static int32_t number_records(const share_elements *share, cau_local_work *work, int32_t next,
                              int32_t *last_record)
{
	work->first_record = next++;
	for (int32_t s = work->first; s < work->last; s++)
		for (int i = 0; i < share->vertices; i++) {
			int32_t *last = &last_record[share->vertex_at[i][s]];
			if (share->element_at[s] < 0) {
				share->record_at[i][s] = 0;
				continue;
			}
			if (*last < work->first_record)
				*last = next++;
			share->record_at[i][s] = (uint16_t)(4 * (*last - work->first_record));
		}
	work->record_count = next - work->first_record;
	CAU_ASSERT(work->record_count <= CAU_SHARE_RECORDS, "%d records in a share of at most %d",
	           work->record_count, CAU_SHARE_RECORDS);
	return next;
}

static void name_vertices(const share_elements *share, const cau_local_work *work,
                          int32_t *record_vertex)
{
	for (int32_t s = work->first; s < work->last; s++)
		for (int i = 0; i < share->vertices && share->element_at[s] >= 0; i++)
			record_vertex[work->first_record + share->record_at[i][s] / 4] =
				4 * share->vertex_at[i][s];
}

// Lists the records of each vertex. `first` holds counts at first, then the next free index of each
// list.
static void list_records(const cau_elements *elements, const cau_element_slots *slots,
                         int32_t vertex_count, cau_incidence *incidence)
{
	int32_t *place = incidence->first + 1;
	for (int pass = 0; pass < 2; pass++) {
		for (int32_t w = 0; w < slots->work_count; w++)
			for (int32_t k = 1; k < slots->work[w].record_count; k++) { // record 0 is for padding
				int32_t record = slots->work[w].first_record + k;
				int32_t v = elements->record_vertex[record] / 4;
				CAU_ASSERT_INDEX(v, vertex_count);
				if (!pass)
					place[v + 1]++;
				else
					incidence->record[place[v]++] = record;
			}
		for (int32_t v = 0; !pass && v < vertex_count; v++)
			place[v + 1] += place[v];
	}
}

cau_status cau_elements_make_records(const cau_tissue *tissue, cau_elements *elements,
                                     cau_element_slots *slots, const cau_slot_vertices *vertices,
                                     cau_arena *arena, cau_error *error)
{
	cau_arena scratch = {0};
	cau_incidence *incidence = &slots->incidence;
	size_t n = (size_t)tissue->vertex_count;
	int32_t *last_record = cau_arena_array(&scratch, n, sizeof *last_record);
	if (!last_record)
		return no_memory(error);
	memset(last_record, -1, n * sizeof *last_record);
	for (int32_t w = 0; w < slots->work_count; w++) {
		share_elements share = elements_of(elements, slots, vertices, slots->work[w].kind);
		elements->record_count =
			number_records(&share, &slots->work[w], elements->record_count, last_record);
	}
	cau_arena_finish(&scratch);
	size_t count = (size_t)elements->record_count;
	elements->gradient = cau_arena_array(arena, 4 * count, cau_real_bytes(elements->single));
	elements->record_vertex = cau_arena_array(arena, count, sizeof(int32_t));
	incidence->first = cau_arena_array(arena, n + 2, sizeof(int32_t));
	incidence->record = cau_arena_array(arena, count + CAU_RECORDS_AHEAD, sizeof(int32_t));
	if (!elements->gradient || !elements->record_vertex || !incidence->first || !incidence->record)
		return no_memory(error);
	for (int32_t w = 0; w < slots->work_count; w++) {
		share_elements share = elements_of(elements, slots, vertices, slots->work[w].kind);
		name_vertices(&share, &slots->work[w], elements->record_vertex);
	}
	list_records(elements, slots, tissue->vertex_count, incidence);
	return CAU_OK;
}

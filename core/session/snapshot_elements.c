// SPDX-License-Identifier: GPL-3.0-or-later
// The elements in a snapshot: one after the other by number, whatever slots they stand in, so that
// slots may be laid out anew. Version 1 wrote whole arrays in the order of its slots, padding too;
// it is still read.
#include <stdlib.h>

#include "cautery/assert.h"
#include "session/snapshot_archive.h"

// What comes one after the other: elements, -1 padding.
typedef struct element_order {
	int32_t count, *element; // element NULL: each by its number
	const int32_t *slot_of;
} element_order;

static int32_t element_of(const element_order *order, int32_t place)
{
	CAU_ASSERT_INDEX(place, order->count);
	return order->element ? order->element[place] : place;
}

static void pass_slots(snapshot_archive *archive, void *const *arrays, int count,
                       const element_order *order, bool single)
{
	CAU_ASSERT(order->count >= 0, "%d elements in order", order->count);
	size_t size = cau_real_bytes(single);
	if (!archive->bytes) {
		archive->at += (size_t)count * (size_t)order->count * size;
		return;
	}
	for (int i = 0; i < count; i++)
		for (int32_t k = 0; k < order->count; k++) {
			int32_t element = element_of(order, k);
			if (element < 0)
				archive->at += size;
			else
				snapshot_pass(archive, (char *)arrays[i] + (size_t)order->slot_of[element] * size,
				              size);
		}
}

// What a whole batch is marked with, for each of its elements; version 1 has it once a batch.
static void pass_marks(snapshot_archive *archive, uint8_t *mark, int32_t slot_count,
                       const element_order *order)
{
	int32_t each = order->element ? CAU_BATCH : 1;
	if (archive->reading)
		memset(mark, 0, (size_t)(slot_count / CAU_BATCH));
	for (int32_t k = 0; k < order->count; k += each) {
		int32_t first = element_of(order, k);
		uint8_t value = first < 0 ? 0 : mark[order->slot_of[first] / CAU_BATCH];
		snapshot_pass(archive, &value, 1);
		for (int32_t i = k; i < k + each && archive->reading; i++)
			if (element_of(order, i) >= 0)
				mark[order->slot_of[element_of(order, i)] / CAU_BATCH] |= value;
	}
}

static void pass_all(snapshot_archive *archive, cau_elements *elements,
                     const element_order order[CAU_ELEMENT_KINDS])
{
	cau_sheet_set *sheet = &elements->sheet;
	cau_fat_set *fat = &elements->fat;
	const element_order *triangle = &order[CAU_ELEMENT_TRIANGLE],
						*tetrahedron = &order[CAU_ELEMENT_TETRAHEDRON];
	bool single = elements->single;
	pass_slots(archive, &sheet->weight, 1, triangle, single);
	pass_slots(archive, sheet->target, 3, triangle, single);
	pass_slots(archive, sheet->polar, 6, triangle, single);
	pass_slots(archive, &fat->volume, 1, tetrahedron, single);
	pass_slots(archive, &fat->limit_weight, 1, tetrahedron, single);
	pass_slots(archive, fat->target, 6, tetrahedron, single);
	pass_slots(archive, fat->polar, 4, tetrahedron, single);
	pass_slots(archive, fat->plastic, 6, tetrahedron, single);
	pass_slots(archive, fat->plastic_strain, 6, tetrahedron, single);
	pass_marks(archive, fat->limited, fat->slot_count, tetrahedron);
	pass_marks(archive, fat->flowed, fat->slot_count, tetrahedron);
	pass_slots(archive, &elements->link.weight, 1, &order[CAU_ELEMENT_LINK], single);
	pass_slots(archive, &elements->hinge.weight, 1, &order[CAU_ELEMENT_HINGE], single);
}

// ---- version 1: groups of one layer and material, each padded to whole batches; in every whole
// share of a group sixteen batches, to which its elements were dealt in turn
enum { SHARE_1 = 256, BATCHES_1 = SHARE_1 / CAU_BATCH };

static int32_t padded_1(int32_t count)
{
	return (count + CAU_BATCH - 1) / CAU_BATCH * CAU_BATCH;
}

static int32_t place_1(int32_t k, int32_t count)
{
	CAU_ASSERT_INDEX(k, count);
	int32_t share = k / SHARE_1 * SHARE_1;
	if (share + SHARE_1 > count)
		return k;
	return share + (k - share) % BATCHES_1 * CAU_BATCH + (k - share) / BATCHES_1;
}

// One group's elements, which are those marked with `group` in group_of, from order->count on.
static void order_group_1(element_order *order, const int32_t *group_of, int32_t element_count,
                          int32_t group)
{
	int32_t members = 0, done = 0;
	for (int32_t e = 0; e < element_count; e++)
		members += group_of[e] == group;
	for (int32_t k = 0; k < padded_1(members); k++)
		order->element[order->count + k] = -1;
	for (int32_t e = 0; e < element_count; e++)
		if (group_of[e] == group)
			order->element[order->count + place_1(done++, members)] = e;
	order->count += padded_1(members);
}

static int32_t group_count_of(const cau_elements *elements, int kind)
{
	if (kind == CAU_ELEMENT_TRIANGLE)
		return elements->sheet.group_count;
	return kind == CAU_ELEMENT_TETRAHEDRON ? elements->fat.group_count : 1;
}

static int32_t group_of_slot(const cau_elements *elements, int kind, int32_t slot)
{
	int32_t group = 0, count = group_count_of(elements, kind);
	const cau_sheet_group *sheet = elements->sheet.group;
	const cau_fat_group *fat = elements->fat.group;
	if (kind == CAU_ELEMENT_TRIANGLE)
		while (group < count && slot >= sheet[group].first_slot + sheet[group].slot_count)
			group++;
	else if (kind == CAU_ELEMENT_TETRAHEDRON)
		while (group < count && slot >= fat[group].first_slot + fat[group].slot_count)
			group++;
	CAU_ASSERT(group < count, "slot %d of kind %d is in no group", slot, kind);
	return group;
}

// Links and hinges, of one group, were not dealt.
static cau_status order_kind_1(const cau_session *session, int kind, element_order *order)
{
	const cau_elements *elements = &session->solver.elements;
	int32_t count = cau_tissue_element_count(&session->tissue, kind);
	int32_t groups = group_count_of(elements, kind);
	int dealt = kind == CAU_ELEMENT_TRIANGLE || kind == CAU_ELEMENT_TETRAHEDRON;
	int32_t *group_of = malloc((size_t)count * sizeof *group_of + 1);
	order->element = malloc((size_t)(count + groups * CAU_BATCH) * sizeof *order->element);
	if (!group_of || !order->element) {
		free(group_of);
		return CAU_NO_MEMORY;
	}
	order->count = 0;
	for (int32_t e = 0; e < count; e++)
		group_of[e] = group_of_slot(elements, kind, order->slot_of[e]);
	for (int32_t g = 0; g < groups && dealt; g++)
		order_group_1(order, group_of, count, g);
	if (!dealt)
		for (; order->count < padded_1(count); order->count++)
			order->element[order->count] = order->count < count ? order->count : -1;
	free(group_of);
	return CAU_OK;
}

cau_status cau_snapshot_pass_elements(snapshot_archive *archive, cau_session *session,
                                      cau_error *error)
{
	element_order order[CAU_ELEMENT_KINDS] = {{0}};
	cau_status status = CAU_OK;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS && !status; kind++) {
		order[kind].slot_of = session->solver.slots.slot_of[kind];
		order[kind].count = cau_tissue_element_count(&session->tissue, kind);
		if (archive->version == 1)
			status = order_kind_1(session, kind, &order[kind]);
	}
	if (!status)
		pass_all(archive, &session->solver.elements, order);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		free(order[kind].element);
	return status ? cau_fail(error, status, NULL, "no memory to restore") : CAU_OK;
}

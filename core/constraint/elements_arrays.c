// SPDX-License-Identifier: GPL-3.0-or-later
// Maps between slots and elements, and arrays by slot.
#include "cautery/assert.h"
#include "constraint/elements_internal.h"

cau_status cau_elements_make_maps(cau_element_slots *slots, int kind, int32_t element_count,
                                  int32_t slot_count, cau_arena *arena, cau_error *error)
{
	CAU_ASSERT_INDEX(kind, CAU_ELEMENT_KINDS);
	CAU_ASSERT(slot_count >= element_count && slot_count % CAU_BATCH == 0,
	           "%d slots for %d elements", slot_count, element_count);
	slots->slot_of[kind] = cau_arena_array(arena, (size_t)element_count, sizeof(int32_t));
	slots->element_at[kind] = cau_arena_array(arena, (size_t)slot_count, sizeof(int32_t));
	if (!slots->slot_of[kind] || !slots->element_at[kind])
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the elements");
	for (int32_t s = 0; s < slot_count; s++)
		slots->element_at[kind][s] = -1;
	return CAU_OK;
}

void cau_elements_assign(cau_element_slots *slots, int kind, int32_t element, int32_t slot)
{
	CAU_ASSERT(slots->element_at[kind][slot] < 0, "slot %d has element %d already", slot,
	           slots->element_at[kind][slot]);
	slots->slot_of[kind][element] = slot;
	slots->element_at[kind][slot] = element;
}

bool cau_real_arrays(cau_arena *arena, void **array, int count, int32_t slots, bool single)
{
	for (int i = 0; i < count; i++)
		if (!(array[i] = cau_arena_array(arena, (size_t)slots, cau_real_bytes(single))))
			return false;
	return true;
}

bool cau_index_arrays(cau_arena *arena, uint16_t **array, int count, int32_t slots)
{
	for (int i = 0; i < count; i++)
		if (!(array[i] = cau_arena_array(arena, (size_t)slots, sizeof(uint16_t))))
			return false;
	return true;
}

bool cau_slot_vertices_make(cau_slot_vertices *vertices, int kind, int count, int32_t slots)
{
	CAU_ASSERT(count >= 2 && count <= 4, "%d vertices of kind %d", count, kind);
	int32_t **at = vertices->at[kind];
	for (int i = 0; i < count; i++)
		if (!(at[i] = cau_arena_array(&vertices->arena, (size_t)slots, sizeof(int32_t))))
			return false;
	return true;
}

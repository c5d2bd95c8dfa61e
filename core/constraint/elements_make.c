// SPDX-License-Identifier: GPL-3.0-or-later
// Lays the tissue's elements out in slots, group by group.
#include <math.h>
#include <string.h>

#include "constraint/elements_internal.h"
#include "solve/system.h"

static int32_t pad(int32_t count)
{
	return (count + CAU_BATCH - 1) / CAU_BATCH * CAU_BATCH;
}

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the elements");
}

// ---- groups: elements of one layer and material, in element order
typedef struct group_key {
	int32_t layer, material, count;
} group_key;

static int32_t layer_of(const cau_tissue *tissue, int kind, int32_t element)
{
	return kind == CAU_ELEMENT_TRIANGLE ? tissue->triangle_layer[element]
	                                    : tissue->tetrahedron_layer[element];
}

static int32_t material_of(const cau_tissue *tissue, int kind, int32_t element)
{
	return kind == CAU_ELEMENT_TRIANGLE ? tissue->triangle_material[element]
	                                    : tissue->tetrahedron_material[element];
}

static int32_t count_groups(const cau_tissue *tissue, int kind, group_key *keys)
{
	int32_t count = 0;
	for (int32_t e = 0; e < cau_tissue_element_count(tissue, kind); ++e) {
		int32_t layer = layer_of(tissue, kind, e), material = material_of(tissue, kind, e), g = 0;
		while (g < count && (keys[g].layer != layer || keys[g].material != material))
			g++;
		if (g == count)
			keys[count++] = (group_key){layer, material, 0};
		keys[g].count++;
	}
	return count;
}

// Gives every element of the groups a slot; first_slot (count) is where each group starts.
static int32_t place(const group_key *keys, int32_t count, int32_t *first_slot)
{
	int32_t slots = 0;
	for (int32_t g = 0; g < count; ++g) {
		first_slot[g] = slots;
		slots += pad(keys[g].count);
	}
	return slots;
}

// Where in its group the k-th of `count` elements goes. Neighbours in the mesh follow each other
// and share vertices: in each whole share they are dealt to the batches in turn, so that the lanes
// of one batch rarely add to one record, which each would have to wait for.
static int32_t spread(int32_t k, int32_t count)
{
	int32_t share = k / CAU_SHARE * CAU_SHARE, batches = CAU_SHARE / CAU_BATCH;
	if (share + CAU_SHARE > count)
		return k;
	return share + (k - share) % batches * CAU_BATCH + (k - share) / batches;
}

static cau_status make_maps(cau_element_slots *slots, int kind, int32_t element_count,
                            int32_t slot_count, cau_arena *arena, cau_error *error)
{
	slots->slot_of[kind] = cau_arena_array(arena, (size_t)element_count, sizeof(int32_t));
	slots->element_at[kind] = cau_arena_array(arena, (size_t)slot_count, sizeof(int32_t));
	if (!slots->slot_of[kind] || !slots->element_at[kind])
		return no_memory(error);
	for (int32_t s = 0; s < slot_count; ++s)
		slots->element_at[kind][s] = -1;
	return CAU_OK;
}

static void assign(cau_element_slots *slots, int kind, int32_t element, int32_t slot)
{
	slots->slot_of[kind][element] = slot;
	slots->element_at[kind][slot] = element;
}

static int arrays(cau_arena *arena, void **array, int count, int32_t slots, int single)
{
	for (int i = 0; i < count; ++i)
		if (!(array[i] = cau_arena_array(arena, (size_t)slots, cau_real_bytes(single))))
			return 0;
	return 1;
}

static int index_arrays(cau_arena *arena, int32_t **array, int count, int32_t slots)
{
	for (int i = 0; i < count; ++i)
		if (!(array[i] = cau_arena_array(arena, (size_t)slots, sizeof(int32_t))))
			return 0;
	return 1;
}

// ---- sets
static cau_status make_sheets(const cau_tissue *tissue, int single, cau_arena *arena,
                              cau_elements *elements, cau_element_slots *slots, cau_error *error)
{
	cau_sheet_set *set = &elements->sheet;
	group_key keys[CAU_MAX_GROUPS];
	int32_t first[CAU_MAX_GROUPS] = {0};
	set->group_count = count_groups(tissue, CAU_ELEMENT_TRIANGLE, keys);
	set->slot_count = place(keys, set->group_count, first);
	set->group = cau_arena_array(arena, (size_t)set->group_count, sizeof *set->group);
	cau_status status = make_maps(slots, CAU_ELEMENT_TRIANGLE, tissue->triangle_count,
	                              set->slot_count, arena, error);
	if (status)
		return status;
	if (!set->group || !index_arrays(arena, set->vertex_at, 3, set->slot_count) ||
	    !index_arrays(arena, set->record_at, 3, set->slot_count) ||
	    !arrays(arena, set->dm_inverse, 4, set->slot_count, single) ||
	    !arrays(arena, set->rest, 6, set->slot_count, single) ||
	    !arrays(arena, &set->weight, 1, set->slot_count, single) ||
	    !arrays(arena, set->target, 3, set->slot_count, single) ||
	    !arrays(arena, set->polar, 6, set->slot_count, single) ||
	    !arrays(arena, &set->position_scale, 1, set->slot_count, single))
		return no_memory(error);
	for (int32_t g = 0; g < set->group_count; ++g) {
		set->group[g] = (cau_sheet_group){.first_slot = first[g],
		                                  .slot_count = pad(keys[g].count),
		                                  .layer = keys[g].layer,
		                                  .material = keys[g].material};
		int32_t done = 0;
		for (int32_t t = 0; t < tissue->triangle_count; ++t) {
			if (tissue->triangle_layer[t] != keys[g].layer ||
			    tissue->triangle_material[t] != keys[g].material)
				continue;
			int32_t slot = first[g] + spread(done++, keys[g].count);
			assign(slots, CAU_ELEMENT_TRIANGLE, t, slot);
			cau_element_map map;
			cau_tissue_element_map(tissue, CAU_ELEMENT_TRIANGLE, t, &map);
			for (int i = 0; i < 3; ++i)
				set->vertex_at[i][slot] = 4 * map.vertex[i];
			for (int i = 0; i < 4; ++i)
				cau_real_set(set->dm_inverse[i], single, slot,
				             tissue->triangle_dm_inverse[4 * (size_t)t + (size_t)i]);
			for (int i = 0; i < 6; ++i) {
				double axis = tissue->triangle_frame[6 * (size_t)t + (size_t)i];
				cau_real_set(set->rest[i], single, slot, axis);
				cau_real_set(set->polar[i], single, slot, axis);
			}
			cau_real_set(set->position_scale, single, slot, cau_element_map_scale(&map));
		}
	}
	return CAU_OK;
}

static cau_status make_fat(const cau_tissue *tissue, int single, cau_arena *arena,
                           cau_elements *elements, cau_element_slots *slots, cau_error *error)
{
	cau_fat_set *set = &elements->fat;
	group_key keys[CAU_MAX_GROUPS];
	int32_t first[CAU_MAX_GROUPS] = {0};
	set->group_count = count_groups(tissue, CAU_ELEMENT_TETRAHEDRON, keys);
	set->slot_count = place(keys, set->group_count, first);
	set->group = cau_arena_array(arena, (size_t)set->group_count, sizeof *set->group);
	set->limited = cau_arena_array(arena, (size_t)(set->slot_count / CAU_BATCH), 1);
	set->flowed = cau_arena_array(arena, (size_t)(set->slot_count / CAU_BATCH), 1);
	cau_status status = make_maps(slots, CAU_ELEMENT_TETRAHEDRON, tissue->tetrahedron_count,
	                              set->slot_count, arena, error);
	if (status)
		return status;
	if (!set->group || !set->limited || !set->flowed ||
	    !index_arrays(arena, set->vertex_at, 4, set->slot_count) ||
	    !index_arrays(arena, set->record_at, 4, set->slot_count) ||
	    !arrays(arena, set->dm_inverse, 9, set->slot_count, single) ||
	    !arrays(arena, &set->volume, 1, set->slot_count, single) ||
	    !arrays(arena, &set->limit_weight, 1, set->slot_count, single) ||
	    !arrays(arena, set->target, 6, set->slot_count, single) ||
	    !arrays(arena, set->polar, 4, set->slot_count, single) ||
	    !arrays(arena, set->plastic, 6, set->slot_count, single) ||
	    !arrays(arena, set->plastic_strain, 6, set->slot_count, single) ||
	    !arrays(arena, &set->position_scale, 1, set->slot_count, single))
		return no_memory(error);
	for (int32_t g = 0; g < set->group_count; ++g) {
		set->group[g] = (cau_fat_group){.first_slot = first[g],
		                                .slot_count = pad(keys[g].count),
		                                .layer = keys[g].layer,
		                                .material = keys[g].material};
		int32_t done = 0;
		for (int32_t t = 0; t < tissue->tetrahedron_count; ++t) {
			if (tissue->tetrahedron_layer[t] != keys[g].layer ||
			    tissue->tetrahedron_material[t] != keys[g].material)
				continue;
			int32_t slot = first[g] + spread(done++, keys[g].count);
			assign(slots, CAU_ELEMENT_TETRAHEDRON, t, slot);
			cau_element_map map;
			cau_tissue_element_map(tissue, CAU_ELEMENT_TETRAHEDRON, t, &map);
			for (int i = 0; i < 4; ++i)
				set->vertex_at[i][slot] = 4 * map.vertex[i];
			for (int i = 0; i < 9; ++i) {
				cau_real_set(set->dm_inverse[i], single, slot,
				             tissue->tetrahedron_dm_inverse[9 * (size_t)t + (size_t)i]);
			}
			cau_real_set(set->position_scale, single, slot, cau_element_map_scale(&map));
		}
	}
	for (int32_t s = 0; s < set->slot_count; ++s) {
		cau_real_set(set->polar[0], single, s, 1);
		for (int i = 0; i < 3; ++i) // padding has the identity for a target
			cau_real_set(set->target[i], single, s, 1);
	}
	return CAU_OK;
}

static void rest_combination(const cau_tissue *tissue, const cau_element_map *map, double rest[3])
{
	for (int c = 0; c < 3; ++c) {
		rest[c] = 0;
		for (int i = 0; i < map->vertex_count; ++i)
			rest[c] +=
				map->coefficient[0][i] * tissue->rest[3 * (size_t)map->vertex[i] + (size_t)c];
	}
}

static cau_status make_links(const cau_tissue *tissue, int single, cau_arena *arena,
                             cau_elements *elements, cau_element_slots *slots, cau_error *error)
{
	cau_link_set *set = &elements->link;
	set->slot_count = pad(tissue->link_count);
	cau_status status =
		make_maps(slots, CAU_ELEMENT_LINK, tissue->link_count, set->slot_count, arena, error);
	if (status)
		return status;
	if (!index_arrays(arena, set->vertex_at, 2, set->slot_count) ||
	    !index_arrays(arena, set->record_at, 2, set->slot_count) ||
	    !arrays(arena, set->rest, 3, set->slot_count, single) ||
	    !arrays(arena, &set->rest_length, 1, set->slot_count, single) ||
	    !arrays(arena, &set->weight, 1, set->slot_count, single))
		return no_memory(error);
	for (int32_t k = 0; k < tissue->link_count; ++k) {
		cau_element_map map;
		double rest[3];
		cau_tissue_element_map(tissue, CAU_ELEMENT_LINK, k, &map);
		rest_combination(tissue, &map, rest);
		assign(slots, CAU_ELEMENT_LINK, k, k);
		for (int i = 0; i < 2; ++i)
			set->vertex_at[i][k] = 4 * map.vertex[i];
		for (int c = 0; c < 3; ++c)
			cau_real_set(set->rest[c], single, k, rest[c]);
		cau_real_set(set->rest_length, single, k, tissue->link_length[k]);
	}
	return CAU_OK;
}

static cau_status make_hinges(const cau_tissue *tissue, int single, cau_arena *arena,
                              cau_elements *elements, cau_element_slots *slots, cau_error *error)
{
	cau_hinge_set *set = &elements->hinge;
	set->slot_count = pad(tissue->hinge_count);
	cau_status status =
		make_maps(slots, CAU_ELEMENT_HINGE, tissue->hinge_count, set->slot_count, arena, error);
	if (status)
		return status;
	if (!index_arrays(arena, set->vertex_at, 4, set->slot_count) ||
	    !index_arrays(arena, set->record_at, 4, set->slot_count) ||
	    !arrays(arena, set->coefficient, 4, set->slot_count, single) ||
	    !arrays(arena, set->rest, 3, set->slot_count, single) ||
	    !arrays(arena, &set->rest_length, 1, set->slot_count, single) ||
	    !arrays(arena, &set->weight, 1, set->slot_count, single))
		return no_memory(error);
	for (int32_t k = 0; k < tissue->hinge_count; ++k) {
		cau_element_map map;
		double rest[3], size = 0;
		cau_tissue_element_map(tissue, CAU_ELEMENT_HINGE, k, &map);
		rest_combination(tissue, &map, rest);
		assign(slots, CAU_ELEMENT_HINGE, k, k);
		for (int i = 0; i < 4; ++i) {
			set->vertex_at[i][k] = 4 * map.vertex[i];
			cau_real_set(set->coefficient[i], single, k, map.coefficient[0][i]);
		}
		double length = sqrt(rest[0] * rest[0] + rest[1] * rest[1] + rest[2] * rest[2]);
		for (int c = 0; c < 3; ++c) {
			double span = tissue->rest[3 * (size_t)map.vertex[1] + (size_t)c] -
			              tissue->rest[3 * (size_t)map.vertex[0] + (size_t)c];
			size += span * span;
		}
		int flat = length < 1e-6 * sqrt(size);
		for (int c = 0; c < 3; ++c)
			cau_real_set(set->rest[c], single, k, flat ? 0 : rest[c]);
		cau_real_set(set->rest_length, single, k, flat ? 0 : length);
	}
	return CAU_OK;
}

cau_status cau_elements_make(const cau_tissue *tissue, int single, cau_arena *arena,
                             cau_elements *elements, cau_element_slots *slots, cau_error *error)
{
	memset(elements, 0, sizeof *elements);
	memset(slots, 0, sizeof *slots);
	elements->single = single;
	cau_status status = make_sheets(tissue, single, arena, elements, slots, error);
	if (!status)
		status = make_fat(tissue, single, arena, elements, slots, error);
	if (!status)
		status = make_links(tissue, single, arena, elements, slots, error);
	if (!status)
		status = make_hinges(tissue, single, arena, elements, slots, error);
	if (!status)
		status = cau_elements_make_work(elements, slots, arena, error);
	if (!status)
		status = cau_elements_make_records(tissue, elements, slots, arena, error);
	return status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Lays the tissue's elements out in slots, group by group.
#include <math.h>
#include <string.h>

#include "constraint/elements_internal.h"
#include "constraint/pairs.h"
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

// Where the first of the k-th pair goes in a group of `slots`; the second is a batch behind it.
// Neighbours in the mesh follow each other and share vertices: in each whole share they are dealt
// to the batches in turn, so that the lanes of one batch rarely add to one record, which each would
// have to wait for.
static int32_t pair_slot(int32_t k, int32_t slots)
{
	enum { PAIRS = CAU_SHARE / 2, BATCHES = PAIRS / CAU_BATCH };
	int32_t share = k / PAIRS, in_share = k % PAIRS;
	int32_t batch = in_share / CAU_BATCH, lane = in_share % CAU_BATCH;
	if ((share + 1) * CAU_SHARE <= slots) {
		batch = in_share % BATCHES;
		lane = in_share / BATCHES;
	}
	return share * CAU_SHARE + batch * 2 * CAU_BATCH + lane;
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

// ---- sets of pairs: triangles and tetrahedra
typedef struct pair_maker {
	const cau_tissue *tissue;
	cau_elements *elements;
	cau_element_slots *slots;
	int kind;
	int32_t *partner; // by element
	void (*fill)(const struct pair_maker *maker, int32_t element, int32_t slot, const int *order);
} pair_maker;

// Gives every pair of the group its slots.
static void place_pairs(const pair_maker *maker, const group_key *key, int32_t first_slot,
                        int32_t slot_count)
{
	int32_t done = 0, count = cau_tissue_element_count(maker->tissue, maker->kind);
	for (int32_t e = 0; e < count; ++e) {
		if (layer_of(maker->tissue, maker->kind, e) != key->layer ||
		    material_of(maker->tissue, maker->kind, e) != key->material ||
		    (maker->partner[e] >= 0 && maker->partner[e] < e))
			continue;
		int32_t slot = first_slot + pair_slot(done++, slot_count);
		const int32_t half[2] = {e, maker->partner[e]};
		for (int h = 0; h < 2 && half[h] >= 0; ++h, slot += CAU_BATCH) {
			int order[4];
			cau_pair_order(maker->tissue, maker->kind, e, maker->partner[e], half[h], order);
			assign(maker->slots, maker->kind, half[h], slot);
			maker->fill(maker, half[h], slot, order);
		}
	}
}

static cau_status make_sheet_arrays(int single, cau_arena *arena, cau_sheet_set *set,
                                    cau_error *error)
{
	if (!index_arrays(arena, set->vertex_at, 3, set->slot_count) ||
	    !index_arrays(arena, set->record_at, 3, set->slot_count) ||
	    !arrays(arena, set->dm_inverse, 4, set->slot_count, single) ||
	    !arrays(arena, set->rest, 6, set->slot_count, single) ||
	    !arrays(arena, &set->weight, 1, set->slot_count, single) ||
	    !arrays(arena, set->target, 3, set->slot_count, single) ||
	    !arrays(arena, set->polar, 6, set->slot_count, single) ||
	    !arrays(arena, &set->position_scale, 1, set->slot_count, single))
		return no_memory(error);
	return CAU_OK;
}

static void fill_sheet_slot(const pair_maker *maker, int32_t triangle, int32_t slot,
                            const int *order)
{
	cau_sheet_set *set = &maker->elements->sheet;
	int single = maker->elements->single;
	cau_element_map map;
	cau_tissue_element_map(maker->tissue, CAU_ELEMENT_TRIANGLE, triangle, &map);
	for (int i = 0; i < 3; ++i)
		set->vertex_at[i][slot] = 4 * map.vertex[order[i]];
	for (int i = 0; i < 4; ++i)
		cau_real_set(set->dm_inverse[i], single, slot, map.coefficient[i % 2][order[i / 2 + 1]]);
	for (int i = 0; i < 6; ++i) {
		double axis = maker->tissue->triangle_frame[6 * (size_t)triangle + (size_t)i];
		cau_real_set(set->rest[i], single, slot, axis);
		cau_real_set(set->polar[i], single, slot, axis);
	}
	cau_real_set(set->position_scale, single, slot, cau_element_map_scale(&map));
}

static cau_status make_fat_arrays(int single, cau_arena *arena, cau_fat_set *set, cau_error *error)
{
	set->limited = cau_arena_array(arena, (size_t)(set->slot_count / CAU_BATCH), 1);
	set->flowed = cau_arena_array(arena, (size_t)(set->slot_count / CAU_BATCH), 1);
	if (!set->limited || !set->flowed || !index_arrays(arena, set->vertex_at, 4, set->slot_count) ||
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
	for (int32_t s = 0; s < set->slot_count; ++s) {
		cau_real_set(set->polar[0], single, s, 1);
		for (int i = 0; i < 3; ++i) // padding has the identity for a target
			cau_real_set(set->target[i], single, s, 1);
	}
	return CAU_OK;
}

static void fill_fat_slot(const pair_maker *maker, int32_t tetrahedron, int32_t slot,
                          const int *order)
{
	cau_fat_set *set = &maker->elements->fat;
	int single = maker->elements->single;
	cau_element_map map;
	cau_tissue_element_map(maker->tissue, CAU_ELEMENT_TETRAHEDRON, tetrahedron, &map);
	for (int i = 0; i < 4; ++i)
		set->vertex_at[i][slot] = 4 * map.vertex[order[i]];
	for (int i = 0; i < 9; ++i)
		cau_real_set(set->dm_inverse[i], single, slot, map.coefficient[i % 3][order[i / 3 + 1]]);
	cau_real_set(set->position_scale, single, slot, cau_element_map_scale(&map));
}

// The groups of one kind, their elements paired; returns the slots they take.
static int32_t pair_groups(const pair_maker *maker, const group_key *keys, int32_t count,
                           int32_t *slot_count)
{
	int32_t total = 0;
	for (int32_t g = 0; g < count; ++g) {
		slot_count[g] = 2 * pad(cau_pair_elements(maker->tissue, maker->kind, keys[g].layer,
		                                          keys[g].material, maker->partner));
		total += slot_count[g];
	}
	return total;
}

static cau_status make_sheets(pair_maker *maker, cau_arena *arena, cau_error *error)
{
	cau_sheet_set *set = &maker->elements->sheet;
	group_key keys[CAU_MAX_GROUPS];
	int32_t slots[CAU_MAX_GROUPS], first = 0;
	maker->kind = CAU_ELEMENT_TRIANGLE;
	maker->fill = fill_sheet_slot;
	set->group_count = count_groups(maker->tissue, maker->kind, keys);
	set->slot_count = pair_groups(maker, keys, set->group_count, slots);
	set->group = cau_arena_array(arena, (size_t)set->group_count, sizeof *set->group);
	cau_status status = set->group ? CAU_OK : no_memory(error);
	if (!status)
		status = make_maps(maker->slots, maker->kind, maker->tissue->triangle_count,
		                   set->slot_count, arena, error);
	if (!status)
		status = make_sheet_arrays(maker->elements->single, arena, set, error);
	for (int32_t g = 0; !status && g < set->group_count; first += slots[g++]) {
		set->group[g] = (cau_sheet_group){.first_slot = first,
		                                  .slot_count = slots[g],
		                                  .layer = keys[g].layer,
		                                  .material = keys[g].material};
		place_pairs(maker, &keys[g], first, slots[g]);
	}
	return status;
}

static cau_status make_fat(pair_maker *maker, cau_arena *arena, cau_error *error)
{
	cau_fat_set *set = &maker->elements->fat;
	group_key keys[CAU_MAX_GROUPS];
	int32_t slots[CAU_MAX_GROUPS], first = 0;
	maker->kind = CAU_ELEMENT_TETRAHEDRON;
	maker->fill = fill_fat_slot;
	set->group_count = count_groups(maker->tissue, maker->kind, keys);
	set->slot_count = pair_groups(maker, keys, set->group_count, slots);
	set->group = cau_arena_array(arena, (size_t)set->group_count, sizeof *set->group);
	cau_status status = set->group ? CAU_OK : no_memory(error);
	if (!status)
		status = make_maps(maker->slots, maker->kind, maker->tissue->tetrahedron_count,
		                   set->slot_count, arena, error);
	if (!status)
		status = make_fat_arrays(maker->elements->single, arena, set, error);
	for (int32_t g = 0; !status && g < set->group_count; first += slots[g++]) {
		set->group[g] = (cau_fat_group){.first_slot = first,
		                                .slot_count = slots[g],
		                                .layer = keys[g].layer,
		                                .material = keys[g].material};
		place_pairs(maker, &keys[g], first, slots[g]);
	}
	return status;
}

static cau_status make_sets_of_pairs(const cau_tissue *tissue, cau_arena *arena,
                                     cau_elements *elements, cau_element_slots *slots,
                                     cau_error *error)
{
	cau_arena scratch = {0};
	int32_t most = tissue->triangle_count > tissue->tetrahedron_count ? tissue->triangle_count
	                                                                  : tissue->tetrahedron_count;
	pair_maker maker = {.tissue = tissue, .elements = elements, .slots = slots};
	maker.partner = cau_arena_array(&scratch, (size_t)most, sizeof *maker.partner);
	cau_status status = maker.partner ? CAU_OK : no_memory(error);
	if (!status)
		status = make_sheets(&maker, arena, error);
	if (!status)
		status = make_fat(&maker, arena, error);
	cau_arena_finish(&scratch);
	return status;
}

// ---- links and hinges
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
	cau_status status = make_sets_of_pairs(tissue, arena, elements, slots, error);
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

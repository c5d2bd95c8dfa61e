// SPDX-License-Identifier: GPL-3.0-or-later
// Lays out the tissue's elements in slots: links and hinges here, triangles and tetrahedra in
// elements_pairs.c.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "constraint/elements_internal.h"

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the elements");
}

static void rest_combination(const cau_tissue *tissue, const cau_element_map *map, double rest[3])
{
	CAU_ASSERT(map->rank == 1, "a combination of rank %d", map->rank);
	for (int c = 0; c < 3; c++) {
		rest[c] = 0;
		for (int i = 0; i < map->vertex_count; i++)
			rest[c] +=
				map->coefficient[0][i] * tissue->rest[3 * (size_t)map->vertex[i] + (size_t)c];
	}
}

static cau_status make_links(const cau_tissue *tissue, bool single, cau_arena *arena,
                             cau_elements *elements, cau_element_slots *slots,
                             cau_slot_vertices *vertices, cau_error *error)
{
	cau_link_set *set = &elements->link;
	set->slot_count = cau_slots_padded(tissue->link_count);
	cau_status status = cau_elements_make_maps(slots, CAU_ELEMENT_LINK, tissue->link_count,
	                                           set->slot_count, arena, error);
	if (status)
		return status;
	if (!cau_slot_vertices_make(vertices, CAU_ELEMENT_LINK, 2, set->slot_count) ||
	    !cau_index_arrays(arena, set->record_at, 2, set->slot_count) ||
	    !cau_real_arrays(arena, set->rest, 3, set->slot_count, single) ||
	    !cau_real_arrays(arena, &set->rest_length, 1, set->slot_count, single) ||
	    !cau_real_arrays(arena, &set->weight, 1, set->slot_count, single))
		return no_memory(error);
	for (int32_t k = 0; k < tissue->link_count; k++) {
		cau_element_map map;
		double rest[3];
		cau_tissue_element_map(tissue, CAU_ELEMENT_LINK, k, &map);
		rest_combination(tissue, &map, rest);
		cau_elements_assign(slots, CAU_ELEMENT_LINK, k, k);
		for (int i = 0; i < 2; i++)
			vertices->at[CAU_ELEMENT_LINK][i][k] = map.vertex[i];
		for (int c = 0; c < 3; c++)
			cau_real_set(set->rest[c], single, k, rest[c]);
		cau_real_set(set->rest_length, single, k, tissue->link_length[k]);
	}
	return CAU_OK;
}

static cau_status make_hinges(const cau_tissue *tissue, bool single, cau_arena *arena,
                              cau_elements *elements, cau_element_slots *slots,
                              cau_slot_vertices *vertices, cau_error *error)
{
	cau_hinge_set *set = &elements->hinge;
	set->slot_count = cau_slots_padded(tissue->hinge_count);
	cau_status status = cau_elements_make_maps(slots, CAU_ELEMENT_HINGE, tissue->hinge_count,
	                                           set->slot_count, arena, error);
	if (status)
		return status;
	if (!cau_slot_vertices_make(vertices, CAU_ELEMENT_HINGE, 4, set->slot_count) ||
	    !cau_index_arrays(arena, set->record_at, 4, set->slot_count) ||
	    !cau_real_arrays(arena, set->coefficient, 4, set->slot_count, single) ||
	    !cau_real_arrays(arena, set->rest, 3, set->slot_count, single) ||
	    !cau_real_arrays(arena, &set->rest_length, 1, set->slot_count, single) ||
	    !cau_real_arrays(arena, &set->weight, 1, set->slot_count, single))
		return no_memory(error);
	for (int32_t k = 0; k < tissue->hinge_count; k++) {
		cau_element_map map;
		double rest[3], size = 0;
		cau_tissue_element_map(tissue, CAU_ELEMENT_HINGE, k, &map);
		rest_combination(tissue, &map, rest);
		cau_elements_assign(slots, CAU_ELEMENT_HINGE, k, k);
		for (int i = 0; i < 4; i++) {
			vertices->at[CAU_ELEMENT_HINGE][i][k] = map.vertex[i];
			cau_real_set(set->coefficient[i], single, k, map.coefficient[0][i]);
		}
		double length = sqrt(rest[0] * rest[0] + rest[1] * rest[1] + rest[2] * rest[2]);
		for (int c = 0; c < 3; c++) {
			double span = tissue->rest[3 * (size_t)map.vertex[1] + (size_t)c] -
			              tissue->rest[3 * (size_t)map.vertex[0] + (size_t)c];
			size += span * span;
		}
		// The curvature of a flat hinge at rest is only rounding. Such a curvature is replaced by
		// 0, so that the hinge has no force at rest.
		bool flat = length < 1e-6 * sqrt(size);
		for (int c = 0; c < 3; c++)
			cau_real_set(set->rest[c], single, k, flat ? 0 : rest[c]);
		cau_real_set(set->rest_length, single, k, flat ? 0 : length);
	}
	return CAU_OK;
}

cau_status cau_elements_make(const cau_tissue *tissue, bool single, cau_arena *arena,
                             cau_elements *elements, cau_element_slots *slots, cau_error *error)
{
	cau_slot_vertices vertices = {0};
	memset(elements, 0, sizeof *elements);
	memset(slots, 0, sizeof *slots);
	elements->single = single;
	cau_status status = cau_elements_make_pairs(tissue, elements, slots, &vertices, arena, error);
	if (!status)
		status = make_links(tissue, single, arena, elements, slots, &vertices, error);
	if (!status)
		status = make_hinges(tissue, single, arena, elements, slots, &vertices, error);
	if (!status)
		status = cau_elements_make_work(tissue, elements, slots, arena, error);
	if (!status)
		status = cau_elements_make_records(tissue, elements, slots, &vertices, arena, error);
	cau_arena_finish(&vertices.arena);
	return status;
}

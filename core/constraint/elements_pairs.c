// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of elements, and the sets of triangles and tetrahedra that are made of the pairs.
#include "constraint/elements_internal.h"

#include "cautery/assert.h"

// ---- maps between slots and elements, and arrays by slot
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

// ---- pairs
static const int32_t FREE = -2; // partner of an element that is not paired yet

// most neighbours that are listed; at an edge of many triangles, further neighbours are ignored
enum { MOST_NEIGHBOURS = 12 };

static bool in_group(const cau_tissue *tissue, int kind, int32_t e, int32_t layer, int32_t material)
{
	return kind == CAU_ELEMENT_TRIANGLE
	           ? tissue->triangle_layer[e] == layer && tissue->triangle_material[e] == material
	           : tissue->tetrahedron_layer[e] == layer &&
	                 tissue->tetrahedron_material[e] == material;
}

static int add_free(const int32_t *partner, int32_t element, int32_t *list, int count)
{
	CAU_ASSERT(count >= 0 && count <= MOST_NEIGHBOURS, "%d neighbours", count);
	if (element < 0 || partner[element] != FREE || count == MOST_NEIGHBOURS)
		return count;
	list[count] = element;
	return count + 1;
}

// Lists the elements that share a face (tetrahedra) or an edge (triangles) with element e, and have
// no partner yet. Returns their number.
static int free_neighbours(const cau_tissue *tissue, int kind, const int32_t *partner, int32_t e,
                           int32_t list[MOST_NEIGHBOURS])
{
	int count = 0;
	if (kind == CAU_ELEMENT_TETRAHEDRON) {
		for (int i = 0; i < 4; i++) {
			const int32_t *owner =
				tissue->faces.owner + 2 * tissue->faces.tetrahedron_face[4 * e + i];
			count = add_free(partner, owner[0] == e ? owner[1] : owner[0], list, count);
		}
		return count;
	}
	const int32_t *first = tissue->edges.first[CAU_PRIMITIVE_TRIANGLE];
	const int32_t *sharer = tissue->edges.sharer[CAU_PRIMITIVE_TRIANGLE];
	for (int i = 0; i < 3; i++) {
		int32_t edge = tissue->edges.triangle_edge[3 * e + i];
		for (int32_t k = first[edge]; k < first[edge + 1]; k++)
			count = add_free(partner, sharer[k] == e ? -1 : sharer[k], list, count);
	}
	return count;
}

// Chooses the free neighbour that itself has the fewest free neighbours, so that few elements
// remain without a partner.
static int32_t choose(const cau_tissue *tissue, int kind, const int32_t *partner, int32_t e)
{
	int32_t near[MOST_NEIGHBOURS], of_near[MOST_NEIGHBOURS], best = -1;
	CAU_ASSERT(partner[e] != FREE, "element %d may choose itself", e);
	int fewest = MOST_NEIGHBOURS + 1, count = free_neighbours(tissue, kind, partner, e, near);
	for (int i = 0; i < count; i++) {
		int others = free_neighbours(tissue, kind, partner, near[i], of_near);
		if (others < fewest) {
			fewest = others;
			best = near[i];
		}
	}
	return best;
}

int32_t cau_pair_elements(const cau_tissue *tissue, int kind, int32_t layer, int32_t material,
                          int32_t *partner)
{
	CAU_ASSERT(kind == CAU_ELEMENT_TRIANGLE || kind == CAU_ELEMENT_TETRAHEDRON,
	           "kind %d has no pairs", kind);
	int32_t pairs = 0, count = cau_tissue_element_count(tissue, kind);
	for (int32_t e = 0; e < count; e++)
		if (in_group(tissue, kind, e, layer, material))
			partner[e] = FREE;
	for (int32_t e = 0; e < count; e++) {
		if (!in_group(tissue, kind, e, layer, material) || partner[e] != FREE)
			continue;
		partner[e] = -1;
		int32_t other = choose(tissue, kind, partner, e);
		CAU_ASSERT(other < 0 || partner[other] == FREE, "element %d is paired twice", other);
		partner[e] = other;
		if (other >= 0)
			partner[other] = e;
		pairs++;
	}
	return pairs;
}

static int place_of(const int32_t *vertices, int count, int32_t vertex)
{
	for (int i = 0; i < count; i++)
		if (vertices[i] == vertex)
			return i;
	return -1;
}

void cau_pair_order(const cau_tissue *tissue, int kind, int32_t first, int32_t other,
                    int32_t element, int *order)
{
	CAU_ASSERT(element == first || element == other, "element %d is in no pair of %d and %d",
	           element, first, other);
	int vertices = kind == CAU_ELEMENT_TRIANGLE ? 3 : 4, shared = vertices - 1, found = 0;
	const int32_t *all = kind == CAU_ELEMENT_TRIANGLE ? tissue->triangle : tissue->tetrahedron;
	const int32_t *a = all + (size_t)vertices * (size_t)first;
	const int32_t *own = all + (size_t)vertices * (size_t)element;
	const int32_t *b = other < 0 ? a : all + (size_t)vertices * (size_t)other;
	// the sum of all vertex indices, from which the shared vertices' indices are subtracted: what
	// is left is the apex
	int apex = vertices * shared / 2;
	for (int i = 0; i < vertices && found < shared; i++)
		if (place_of(b, vertices, a[i]) >= 0) {
			order[found] = place_of(own, vertices, a[i]);
			apex -= order[found++];
		}
	CAU_ASSERT(found == shared, "elements %d and %d share %d vertices", first, other, found);
	CAU_ASSERT_INDEX(apex, vertices);
	order[shared] = apex;
}

// ---- sets
// Lays out triangles and tetrahedra in slots, pair by pair.

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the elements");
}

// A range of slots for the elements of one layer and material.
typedef struct group_plan {
	int32_t layer, material, first_slot, slot_count;
} group_plan;

typedef struct pair_maker {
	const cau_tissue *tissue;
	cau_elements *elements;
	cau_element_slots *slots;
	cau_slot_vertices *vertices;
	int32_t *partner; // partner of each element

	int kind; // kind of the elements that are being placed; the members below belong to them
	group_plan group[CAU_MAX_GROUPS];
	int32_t group_count, slot_count;
	void (*fill)(const struct pair_maker *maker, int32_t element, int32_t slot, const int *order);
} pair_maker;

static int32_t layer_of(const cau_tissue *tissue, int kind, int32_t element)
{
	CAU_ASSERT(kind == CAU_ELEMENT_TRIANGLE || kind == CAU_ELEMENT_TETRAHEDRON,
	           "kind %d has no pairs", kind);
	return kind == CAU_ELEMENT_TRIANGLE ? tissue->triangle_layer[element]
	                                    : tissue->tetrahedron_layer[element];
}

static int32_t material_of(const cau_tissue *tissue, int kind, int32_t element)
{
	return kind == CAU_ELEMENT_TRIANGLE ? tissue->triangle_material[element]
	                                    : tissue->tetrahedron_material[element];
}

// Lists the groups in the order of their first elements.
static void find_groups(pair_maker *maker)
{
	maker->group_count = 0;
	for (int32_t e = 0; e < cau_tissue_element_count(maker->tissue, maker->kind); e++) {
		int32_t layer = layer_of(maker->tissue, maker->kind, e);
		int32_t material = material_of(maker->tissue, maker->kind, e), g = 0;
		while (g < maker->group_count &&
		       (maker->group[g].layer != layer || maker->group[g].material != material))
			g++;
		CAU_ASSERT(g < CAU_MAX_GROUPS, "more than %d groups", CAU_MAX_GROUPS);
		if (g == maker->group_count)
			maker->group[maker->group_count++] = (group_plan){layer, material, 0, 0};
	}
}

// Finds the groups of `kind`, pairs their elements, and assigns a range of slots to each group.
static cau_status plan_groups(pair_maker *maker, int kind, cau_arena *arena, cau_error *error)
{
	maker->kind = kind;
	maker->slot_count = 0;
	find_groups(maker);
	for (int32_t g = 0; g < maker->group_count; g++) {
		group_plan *group = &maker->group[g];
		group->first_slot = maker->slot_count;
		group->slot_count =
			2 * cau_slots_padded(cau_pair_elements(maker->tissue, kind, group->layer,
		                                           group->material, maker->partner));
		maker->slot_count += group->slot_count;
	}
	return cau_elements_make_maps(maker->slots, kind, cau_tissue_element_count(maker->tissue, kind),
	                              maker->slot_count, arena, error);
}

// Returns the slot of the k-th pair's first element in a group of `slots`; the second element is
// one batch later. Neighbours in the mesh follow each other and share vertices. In each whole share
// they are therefore assigned to the batches in turn. Then the lanes of one batch rarely add to the
// same record, for which each lane would have to wait.
static int32_t pair_slot(int32_t k, int32_t slots)
{
	enum { PAIRS = CAU_SHARE / 2, BATCHES = PAIRS / CAU_BATCH };
	int32_t share = k / PAIRS, in_share = k % PAIRS;
	int32_t batch = in_share / CAU_BATCH, lane = in_share % CAU_BATCH;
	if ((share + 1) * CAU_SHARE <= slots) {
		batch = in_share % BATCHES;
		lane = in_share / BATCHES;
	}
	CAU_ASSERT(lane >= 0 && lane < CAU_BATCH, "lane %d of pair %d", lane, k);
	return share * CAU_SHARE + batch * 2 * CAU_BATCH + lane;
}

static void place_pairs(const pair_maker *maker, const group_plan *group)
{
	int32_t done = 0, count = cau_tissue_element_count(maker->tissue, maker->kind);
	for (int32_t e = 0; e < count; e++) {
		if (layer_of(maker->tissue, maker->kind, e) != group->layer ||
		    material_of(maker->tissue, maker->kind, e) != group->material ||
		    (maker->partner[e] >= 0 && maker->partner[e] < e))
			continue;
		int32_t slot = group->first_slot + pair_slot(done++, group->slot_count);
		CAU_ASSERT(slot < group->first_slot + group->slot_count, "pair %d beyond %d slots", done,
		           group->slot_count);
		const int32_t half[2] = {e, maker->partner[e]};
		for (int h = 0; h < 2 && half[h] >= 0; h++, slot += CAU_BATCH) {
			int order[4];
			cau_pair_order(maker->tissue, maker->kind, e, maker->partner[e], half[h], order);
			cau_elements_assign(maker->slots, maker->kind, half[h], slot);
			maker->fill(maker, half[h], slot, order);
		}
	}
}

static cau_status make_sheet_arrays(const pair_maker *maker, cau_arena *arena, cau_error *error)
{
	cau_sheet_set *set = &maker->elements->sheet;
	bool single = maker->elements->single;
	if (!cau_slot_vertices_make(maker->vertices, maker->kind, 3, set->slot_count) ||
	    !cau_index_arrays(arena, set->record_at, 3, set->slot_count) ||
	    !cau_real_arrays(arena, set->dm_inverse, 4, set->slot_count, single) ||
	    !cau_real_arrays(arena, set->rest, 6, set->slot_count, single) ||
	    !cau_real_arrays(arena, &set->weight, 1, set->slot_count, single) ||
	    !cau_real_arrays(arena, set->target, 3, set->slot_count, single) ||
	    !cau_real_arrays(arena, set->polar, 6, set->slot_count, single) ||
	    !cau_real_arrays(arena, &set->position_scale, 1, set->slot_count, single) ||
	    (maker->tissue->viscous &&
	     !cau_real_arrays(arena, set->strain, 3, set->slot_count, single)))
		return no_memory(error);
	return CAU_OK;
}

static void fill_sheet_slot(const pair_maker *maker, int32_t triangle, int32_t slot,
                            const int *order)
{
	cau_sheet_set *set = &maker->elements->sheet;
	bool single = maker->elements->single;
	cau_element_map map;
	cau_tissue_element_map(maker->tissue, CAU_ELEMENT_TRIANGLE, triangle, &map);
	CAU_ASSERT(map.rank == 2 && map.vertex_count == 3, "triangle %d of rank %d", triangle,
	           map.rank);
	for (int i = 0; i < 3; i++)
		maker->vertices->at[maker->kind][i][slot] = map.vertex[order[i]];
	for (int i = 0; i < 4; i++)
		cau_real_set(set->dm_inverse[i], single, slot, map.coefficient[i % 2][order[i / 2 + 1]]);
	for (int i = 0; i < 6; i++) {
		double axis = maker->tissue->triangle_frame[6 * (size_t)triangle + (size_t)i];
		cau_real_set(set->rest[i], single, slot, axis);
		cau_real_set(set->polar[i], single, slot, axis);
	}
	cau_real_set(set->position_scale, single, slot, cau_element_map_scale(&map));
}

static cau_status make_fat_arrays(const pair_maker *maker, cau_arena *arena, cau_error *error)
{
	cau_fat_set *set = &maker->elements->fat;
	bool single = maker->elements->single;
	set->limited = cau_arena_array(arena, (size_t)(set->slot_count / CAU_BATCH), 1);
	set->targeted = cau_arena_array(arena, (size_t)(set->slot_count / CAU_BATCH), 1);
	set->flowed = cau_arena_array(arena, (size_t)(set->slot_count / CAU_BATCH), 1);
	if (!set->limited || !set->targeted || !set->flowed ||
	    !cau_slot_vertices_make(maker->vertices, maker->kind, 4, set->slot_count) ||
	    !cau_index_arrays(arena, set->record_at, 4, set->slot_count) ||
	    !cau_real_arrays(arena, set->dm_inverse, 9, set->slot_count, single) ||
	    !cau_real_arrays(arena, &set->volume, 1, set->slot_count, single) ||
	    !cau_real_arrays(arena, &set->limit_weight, 1, set->slot_count, single) ||
	    !cau_real_arrays(arena, set->target, 6, set->slot_count, single) ||
	    !cau_real_arrays(arena, set->polar, 4, set->slot_count, single) ||
	    !cau_real_arrays(arena, set->plastic, 6, set->slot_count, single) ||
	    !cau_real_arrays(arena, set->plastic_strain, 6, set->slot_count, single) ||
	    !cau_real_arrays(arena, &set->position_scale, 1, set->slot_count, single) ||
	    (maker->tissue->viscous &&
	     !cau_real_arrays(arena, set->strain, 6, set->slot_count, single)))
		return no_memory(error);
	for (int32_t s = 0; s < set->slot_count; s++) {
		cau_real_set(set->polar[0], single, s, 1);
		for (int i = 0; i < 3; i++) // padding has the identity as its target
			cau_real_set(set->target[i], single, s, 1);
	}
	return CAU_OK;
}

static void fill_fat_slot(const pair_maker *maker, int32_t tetrahedron, int32_t slot,
                          const int *order)
{
	cau_fat_set *set = &maker->elements->fat;
	bool single = maker->elements->single;
	cau_element_map map;
	cau_tissue_element_map(maker->tissue, CAU_ELEMENT_TETRAHEDRON, tetrahedron, &map);
	CAU_ASSERT(map.rank == 3 && map.vertex_count == 4, "tetrahedron %d of rank %d", tetrahedron,
	           map.rank);
	for (int i = 0; i < 4; i++)
		maker->vertices->at[maker->kind][i][slot] = map.vertex[order[i]];
	for (int i = 0; i < 9; i++)
		cau_real_set(set->dm_inverse[i], single, slot, map.coefficient[i % 3][order[i / 3 + 1]]);
	cau_real_set(set->position_scale, single, slot, cau_element_map_scale(&map));
}

static cau_status make_sheets(pair_maker *maker, cau_arena *arena, cau_error *error)
{
	cau_sheet_set *set = &maker->elements->sheet;
	cau_status status = plan_groups(maker, CAU_ELEMENT_TRIANGLE, arena, error);
	set->slot_count = maker->slot_count;
	set->group_count = maker->group_count;
	set->group = cau_arena_array(arena, (size_t)set->group_count, sizeof *set->group);
	if (!status)
		status = set->group ? make_sheet_arrays(maker, arena, error) : no_memory(error);
	maker->fill = fill_sheet_slot;
	for (int32_t g = 0; !status && g < set->group_count; g++) {
		const group_plan *plan = &maker->group[g];
		set->group[g] = (cau_sheet_group){.first_slot = plan->first_slot,
		                                  .slot_count = plan->slot_count,
		                                  .layer = plan->layer,
		                                  .material = plan->material};
		place_pairs(maker, plan);
	}
	return status;
}

static cau_status make_fat(pair_maker *maker, cau_arena *arena, cau_error *error)
{
	cau_fat_set *set = &maker->elements->fat;
	cau_status status = plan_groups(maker, CAU_ELEMENT_TETRAHEDRON, arena, error);
	set->slot_count = maker->slot_count;
	set->group_count = maker->group_count;
	set->group = cau_arena_array(arena, (size_t)set->group_count, sizeof *set->group);
	if (!status)
		status = set->group ? make_fat_arrays(maker, arena, error) : no_memory(error);
	maker->fill = fill_fat_slot;
	for (int32_t g = 0; !status && g < set->group_count; g++) {
		const group_plan *plan = &maker->group[g];
		set->group[g] = (cau_fat_group){.first_slot = plan->first_slot,
		                                .slot_count = plan->slot_count,
		                                .layer = plan->layer,
		                                .material = plan->material};
		place_pairs(maker, plan);
	}
	return status;
}

cau_status cau_elements_make_pairs(const cau_tissue *tissue, cau_elements *elements,
                                   cau_element_slots *slots, cau_slot_vertices *vertices,
                                   cau_arena *arena, cau_error *error)
{
	cau_arena scratch = {0};
	int32_t most = tissue->triangle_count > tissue->tetrahedron_count ? tissue->triangle_count
	                                                                  : tissue->tetrahedron_count;
	pair_maker maker = {
		.tissue = tissue, .elements = elements, .slots = slots, .vertices = vertices};
	maker.partner = cau_arena_array(&scratch, (size_t)most, sizeof *maker.partner);
	cau_status status = maker.partner ? CAU_OK : no_memory(error);
	if (!status)
		status = make_sheets(&maker, arena, error);
	if (!status)
		status = make_fat(&maker, arena, error);
	cau_arena_finish(&scratch);
	return status;
}

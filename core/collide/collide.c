// SPDX-License-Identifier: GPL-3.0-or-later
#include "collide/collide.h"

#include <math.h>

#include "cautery/assert.h"

// Capacity in pairs: PAIRS_OF_VERTEX for each vertex of the tissue, and PAIRS_BESIDES for small
// tissue. The capacity bounds memory: if the list is full, the search keeps only the pairs that
// this step needs (find.c).
enum { PAIRS_OF_VERTEX = 8, PAIRS_BESIDES = 4096 };

// Contact stiffness of a vertex: of_inertia times mass over step squared, plus of_elements times
// the stiffness of its elements. The first part carries gravity. A vertex on a face has a dozen
// pairs, and its weight presses them together by a tenth of a millimetre. The second part meets the
// forces of the elements well before a pair's distance is used up. Both are computed from the
// layers as the scene defines them, whatever is cut, so snapshots do not contain them.
static const double of_inertia = 2, of_elements = 0.1;

static void find_stiffness(cau_collide *collide, double step_s)
{
	const cau_tissue *tissue = collide->tissue;
	double *stiffness = collide->stiffness;
	cau_element_map map;
	CAU_ASSERT(step_s > 0, "a step of %g s", step_s);
	for (int32_t v = 0; v < tissue->vertex_count; v++)
		stiffness[v] = of_inertia * tissue->mass[v] / (step_s * step_s);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t i = 0; i < cau_tissue_element_count(tissue, kind); i++) {
			cau_tissue_element_map(tissue, kind, i, &map);
			for (int k = 0; k < map.vertex_count; k++)
				stiffness[map.vertex[k]] += of_elements * map.weight * cau_element_map_scale(&map);
		}
}

static void find_longest(cau_collide *collide)
{
	const cau_edge_table *edges = &collide->tissue->edges;
	for (int32_t e = 0; e < edges->edge_count; e++) {
		const int32_t *v = edges->vertex + 2 * (size_t)e;
		cau_vec3 from = cau_vec3_of(collide->tissue->rest + 3 * (size_t)v[0]);
		cau_vec3 to = cau_vec3_of(collide->tissue->rest + 3 * (size_t)v[1]);
		double long_m = cau_length(cau_sub(to, from));
		for (int k = 0; k < 2; k++)
			collide->longest_m[v[k]] = fmax(collide->longest_m[v[k]], long_m);
	}
}

static bool make_arrays(cau_collide *collide, cau_arena *arena)
{
	const cau_tissue *tissue = collide->tissue;
	size_t n = (size_t)tissue->vertex_count, blocks = (size_t)collide->surface.block_count;
	size_t pairs = (size_t)collide->most_pairs, box = sizeof(cau_collide_box);
	size_t lanes = sizeof(cau_collide_lanes);
	bool made = true;
	struct {
		void **array;
		size_t count, bytes;
	} arrays[] = {
		{(void **)&collide->exempt, n, 1},
		{(void **)&collide->search.exempt_before, n, 1},
		{(void **)&collide->stiffness, n, sizeof(double)},
		{(void **)&collide->longest_m, n, sizeof(double)},
		{(void **)&collide->range.anchor, 3 * n, sizeof(double)},
		{(void **)&collide->range.reach_m, n, sizeof(double)},
		{(void **)&collide->seen.at, 3 * n, sizeof(double)},
		{(void **)&collide->seen.apart_m, pairs, sizeof(double)},
		{(void **)&collide->pair, pairs, sizeof *collide->pair},
		{(void **)&collide->grip, pairs, sizeof *collide->grip},
		{(void **)&collide->filter.stopped, pairs, sizeof *collide->filter.stopped},
		{(void **)&collide->filter.wanted, 3 * n, sizeof(double)},
		{(void **)&collide->filter.room_m, n, sizeof(double)},
		{(void **)&collide->filter.pushed, n, 1},
		{(void **)&collide->filter.unclear, pairs, sizeof(int32_t)},
		{(void **)&collide->load.is_loaded, n, 1},
		{(void **)&collide->load.vertex, n, sizeof(int32_t)},
		{(void **)&collide->load.gradient, 3 * n, sizeof(double)},
		{(void **)&collide->load.probe, 3 * n, sizeof(double)},
		{(void **)&collide->load.answer, 3 * n, sizeof(double)},
		{(void **)&collide->step, 3 * n, sizeof(double)},
		{(void **)&collide->search.face_box, (size_t)tissue->faces.face_count, box},
		{(void **)&collide->search.edge_box, (size_t)tissue->edges.edge_count, box},
		{(void **)&collide->search.vertex_box, n, box},
		{(void **)&collide->search.block_box[0], blocks, box},
		{(void **)&collide->search.block_box[1], blocks, box},
		{(void **)&collide->search.block_box[2], blocks, box},
		{(void **)&collide->search.slice, blocks, sizeof *collide->search.slice},
		{(void **)&collide->search.fresh_box[0], blocks, box},
		{(void **)&collide->search.fresh_box[1], blocks, box},
		{(void **)&collide->search.fresh_box[2], blocks, box},
		{(void **)&collide->search.place_box, blocks, box},
		{(void **)&collide->search.block_lane, blocks / CAU_LANES + 1, lanes},
		{(void **)&collide->search.touched_lane, blocks / CAU_LANES + 1, lanes},
		{(void **)&collide->search.touched, blocks, sizeof(int32_t)},
		{(void **)&collide->search.is_touched, blocks, 1},
		{(void **)&collide->search.alive_before[0], (size_t)tissue->triangle_count, 1},
		{(void **)&collide->search.alive_before[1], (size_t)tissue->tetrahedron_count, 1},
		{(void **)&collide->search.alive_before[2], (size_t)tissue->link_count, 1},
		{(void **)&collide->search.list[0], blocks * CAU_COLLIDE_SLICE, sizeof(cau_collide_found)},
		{(void **)&collide->search.list[1], blocks * CAU_COLLIDE_SLICE, sizeof(cau_collide_found)},
	};
	for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
		*arrays[i].array = cau_arena_array(arena, arrays[i].count, arrays[i].bytes);
		made &= *arrays[i].array != NULL;
	}
	return made;
}

// Makes the groups of boxes (lanes.h). Each block begins a new group.
static bool make_lanes(cau_collide *collide, cau_arena *arena)
{
	const cau_tissue *tissue = collide->tissue;
	cau_search *search = &collide->search;
	size_t blocks = (size_t)collide->surface.block_count;
	int32_t count[] = {tissue->faces.face_count, tissue->edges.edge_count, tissue->vertex_count};
	bool made = true;
	for (int what = 0; what < 3; what++) {
		size_t groups = (size_t)count[what] / CAU_LANES + blocks + 1;
		search->lane[what] = cau_arena_array(arena, groups, sizeof *search->lane[what]);
		search->fresh_lane[what] = cau_arena_array(arena, groups, 1);
		search->lane_first[what] = cau_arena_array(arena, blocks + 1, sizeof(int32_t));
		made &= search->lane[what] && search->fresh_lane[what] && search->lane_first[what];
	}
	return made;
}

cau_status cau_collide_create(cau_collide *collide, const cau_tissue *tissue, double thickness_m,
                              double friction, double step_s, cau_arena *arena, cau_error *error)
{
	CAU_ASSERT(thickness_m > 0 && friction >= 0, "a thickness of %g m, friction %g", thickness_m,
	           friction);
	*collide = (cau_collide){
		.tissue = tissue,
		.thickness_m = thickness_m,
		.friction = friction,
		.most_pairs = PAIRS_OF_VERTEX * tissue->vertex_count + PAIRS_BESIDES,
	};
	cau_status status = cau_surface_create(&collide->surface, tissue, arena, error);
	if (status)
		return status;
	if (!make_arrays(collide, arena) || !make_lanes(collide, arena))
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for tissue contact");
	find_stiffness(collide, step_s);
	cau_collide_forget_crossed(collide);
	find_longest(collide);
	return CAU_OK;
}

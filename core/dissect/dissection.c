// SPDX-License-Identifier: GPL-3.0-or-later
#include "dissect/dissection_internal.h"

#include <string.h>

#include "cautery/assert.h"

_Static_assert(CAU_MAX_LAYERS <= 16, "a bit of `parted` for each layer");

static const double heat_capacity = 3500; // heat capacity of soft tissue, J/(kg K)

static cau_status list_triangle_hinges(cau_dissection *dissection, cau_arena *arena,
                                       cau_error *error)
{
	const cau_tissue *tissue = dissection->tissue;
	size_t triangles = (size_t)tissue->triangle_count;
	int32_t *first = cau_arena_array(arena, triangles + 2, sizeof *first);
	dissection->triangle_hinge =
		cau_arena_array(arena, 2 * (size_t)tissue->hinge_count, sizeof(int32_t));
	dissection->triangle_hinge_first = first;
	if (!first || !dissection->triangle_hinge)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the hinges");
	int32_t *place = first + 1;
	CAU_ASSERT(!tissue->hinge_count || tissue->triangle_count > 1, "%d hinges of %d triangles",
	           tissue->hinge_count, tissue->triangle_count);
	for (int32_t k = 0; k < 2 * tissue->hinge_count; k++)
		place[tissue->hinge_triangle[k] + 1]++;
	for (int32_t t = 0; t < tissue->triangle_count; t++)
		place[t + 1] += place[t];
	for (int32_t k = 0; k < 2 * tissue->hinge_count; k++)
		dissection->triangle_hinge[place[tissue->hinge_triangle[k]]++] = k / 2;
	return CAU_OK;
}

cau_status cau_dissection_create(cau_dissection *dissection, const cau_tissue *tissue,
                                 uint64_t seed, int parting, cau_arena *arena, cau_error *error)
{
	CAU_ASSERT_INDEX(parting, CAU_PARTING_COUNT);
	size_t edges = (size_t)tissue->edges.edge_count, faces = (size_t)tissue->faces.face_count,
		   total = 0;
	*dissection = (cau_dissection){.tissue = tissue, .seed = seed};
	bool missing = false;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++) {
		dissection->share_count[p] =
			cau_arena_array(arena, (size_t)cau_tissue_element_count(tissue, p), 1);
		missing |= !dissection->share_count[p];
	}
	for (int k = 0; k < CAU_ELEMENT_KINDS; k++) {
		size_t count = (size_t)cau_tissue_element_count(tissue, k);
		dissection->alive.element[k] = cau_arena_array(arena, count, 1);
		missing |= !dissection->alive.element[k];
		total += count;
	}
	dissection->exposure = cau_arena_array(arena, edges, sizeof(double));
	dissection->parted = cau_arena_array(arena, edges, sizeof(uint16_t));
	dissection->touched = cau_arena_array(arena, edges, sizeof(int32_t));
	dissection->touched_mark = cau_arena_array(arena, edges, 1);
	dissection->live_elements =
		cau_arena_array(arena, (size_t)tissue->vertex_count, sizeof(int32_t));
	dissection->face_mask = cau_arena_array(arena, (faces + 31) / 32, sizeof(uint32_t));
	dissection->face_owners = cau_arena_array(arena, faces, 1);
	dissection->removed = cau_arena_array(arena, total, sizeof(cau_removed));
	if (missing || !dissection->exposure || !dissection->parted || !dissection->touched ||
	    !dissection->touched_mark || !dissection->live_elements || !dissection->face_mask ||
	    !dissection->face_owners || !dissection->removed)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the edges");
	cau_status status = list_triangle_hinges(dissection, arena, error);
	if (!status && parting == CAU_PARTING_ELEMENTS)
		status = cau_doses_create(&dissection->doses, tissue, arena, error);
	if (!status)
		status = cau_tears_create(&dissection->tears, tissue, arena, error);
	if (!status)
		cau_dissection_recount(dissection);
	return status;
}

void cau_dissection_begin(cau_dissection *dissection)
{
	CAU_ASSERT(dissection->touched_count <= dissection->tissue->edges.edge_count,
	           "%d edges touched of %d", dissection->touched_count,
	           dissection->tissue->edges.edge_count);
	for (int32_t k = 0; k < dissection->touched_count; k++)
		dissection->touched_mark[dissection->touched[k]] = 0;
	dissection->touched_count = dissection->removed_count = 0;
	cau_doses_begin(&dissection->doses);
}

// ---- exposure
static bool edge_lives(const cau_dissection *dissection, int32_t edge)
{
	CAU_ASSERT_INDEX(edge, dissection->tissue->edges.edge_count);
	const cau_edge_table *edges = &dissection->tissue->edges;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t k = edges->first[p][edge]; k < edges->first[p][edge + 1]; k++)
			if (cau_dissection_lives(dissection, p, edges->sharer[p][k]))
				return true;
	return false;
}

// Returns the heat, J, that an edge takes up. The edge's mass is a twelfth of the mass at its ends:
// about a dozen edges meet at a vertex.
static double heat_taken(const cau_dissection *dissection, int32_t edge, double gain)
{
	CAU_ASSERT(gain > 0, "edge %d takes %g degC s", edge, gain);
	const cau_tissue *tissue = dissection->tissue;
	const cau_edge_table *edges = &tissue->edges;
	double absorption = 0;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS && absorption == 0; p++)
		if (edges->first[p][edge] < edges->first[p][edge + 1])
			absorption = cau_dissection_heat_of(tissue, p, edges->sharer[p][edges->first[p][edge]])
			                 ->absorption_per_s;
	double mass = tissue->mass[edges->vertex[2 * edge]] + tissue->mass[edges->vertex[2 * edge + 1]];
	return gain * absorption * heat_capacity * mass / 12;
}

// True if a sphere can reach the segment. Most edges of a near block are out of reach, so the
// temperature at their ends need not be read.
static bool in_reach(cau_vec3 a, cau_vec3 b, cau_vec3 center, double radius)
{
	cau_vec3 along = cau_sub(b, a), off = cau_sub(cau_add(a, b), cau_add(center, center));
	// the radius is enlarged by a micrometre for rounding
	double twice = 2 * (radius + 1e-6) + cau_length(along);
	return cau_dot(off, off) <= twice * twice;
}

double cau_dissection_expose(cau_dissection *dissection, const cau_near *near,
                             const double *position, const cau_heat_grid *grid,
                             const cau_tool_def *tool, const cau_pose *pose, double jaw,
                             double duration_s)
{
	CAU_ASSERT(duration_s >= 0, "exposed for %g s", duration_s);
	cau_vec3 center;
	double radius, taken = 0;
	cau_tool_bound(tool, CAU_PART_HOT, &center, &radius);
	center = cau_pose_to_world(pose, center);
	for (int32_t block = 0; block < near->block_count; block++) {
		if (!cau_box_meets(&near->edge_box[block], center, radius))
			continue;
		for (int32_t k = near->edge_first[block]; k < near->edge_first[block + 1]; k++) {
			int32_t edge = near->edge[k];
			const int32_t *v = dissection->tissue->edges.vertex + 2 * (size_t)edge;
			cau_vec3 a = cau_vec3_of(position + 3 * (size_t)v[0]);
			cau_vec3 b = cau_vec3_of(position + 3 * (size_t)v[1]);
			if (!in_reach(a, b, center, radius))
				continue;
			double gain = cau_exposure_gain(grid, tool, pose, jaw, a, b, 1, duration_s);
			if (gain <= 0 || !edge_lives(dissection, edge))
				continue;
			dissection->exposure[edge] += gain;
			taken += heat_taken(dissection, edge, gain);
			cau_dissection_touch(dissection, edge);
		}
	}
	if (dissection->doses.dose)
		cau_doses_expose(dissection, near, position, grid, tool, pose, jaw, duration_s);
	return taken;
}

// ---- parting
static double ignition_in_bundles(const cau_dissection *dissection, const cau_heat_material *heat,
                                  int32_t layer, int32_t edge)
{
	CAU_ASSERT(heat->ignition_bundle_m > 0, "bundles of %g m", heat->ignition_bundle_m);
	CAU_ASSERT_INDEX(layer, dissection->tissue->layer_count);
	const cau_tissue *tissue = dissection->tissue;
	const int32_t *ends = tissue->edges.vertex + 2 * (size_t)edge;
	cau_vec3 a = cau_vec3_of(tissue->rest + 3 * (size_t)ends[0]);
	cau_vec3 b = cau_vec3_of(tissue->rest + 3 * (size_t)ends[1]);
	cau_vec3 fibre = cau_unit_or(cau_vec3_of(tissue->layer[layer].def.fibre), (cau_vec3){1, 0, 0});
	return cau_ignition_in_bundles(heat->ignition_c, heat->ignition_spread_c, dissection->seed,
	                               layer, cau_scale(0.5, cau_add(a, b)), fibre,
	                               heat->ignition_bundle_m);
}

// True if an edge ignites in the layer of one of its primitives: xi times the exposure exceeds the
// ignition temperature.
static bool ignites(const cau_dissection *dissection, int primitive, int32_t index, int32_t edge)
{
	const cau_heat_material *heat = cau_dissection_heat_of(dissection->tissue, primitive, index);
	int32_t layer = cau_tissue_layer_of(dissection->tissue, primitive, index);
	double ignition = heat->ignition_bundle_m > 0
	                      ? ignition_in_bundles(dissection, heat, layer, edge)
	                      : cau_ignition_of(heat->ignition_c, heat->ignition_spread_c,
	                                        dissection->seed, layer, edge);
	return heat->absorption_per_s * dissection->exposure[edge] > ignition;
}

// Returns the first kind of primitive that parts by its edges. Links are single fibres, and part by
// their edge under both rules.
static int first_kind_of_edges(const cau_dissection *dissection)
{
	return dissection->doses.dose ? CAU_PRIMITIVE_LINK : CAU_PRIMITIVE_TRIANGLE;
}

// Returns the layers, as bits, in which the edge parts now. Layers in which it has parted before
// are left out.
static uint16_t layers_parting(const cau_dissection *dissection, int32_t edge)
{
	const cau_edge_table *edges = &dissection->tissue->edges;
	uint16_t before = dissection->parted[edge], parting = 0;
	for (int p = first_kind_of_edges(dissection); p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t k = edges->first[p][edge]; k < edges->first[p][edge + 1]; k++) {
			int32_t index = edges->sharer[p][k];
			uint16_t bit = (uint16_t)(1u << cau_tissue_layer_of(dissection->tissue, p, index));
			CAU_ASSERT(bit != 0, "layer %d has no bit",
			           cau_tissue_layer_of(dissection->tissue, p, index));
			if (!((before | parting) & bit) && ignites(dissection, p, index, edge))
				parting |= bit;
		}
	return parting;
}

static void part_edge(cau_dissection *dissection, int32_t edge, uint32_t *layers)
{
	uint16_t parting = layers_parting(dissection, edge);
	*layers |= parting;
	if (parting)
		cau_dissection_lose_edge(dissection, edge, parting);
}

void cau_dissection_part(cau_dissection *dissection, uint32_t *layers)
{
	for (int32_t k = 0; k < dissection->touched_count; k++)
		part_edge(dissection, dissection->touched[k], layers);
	if (dissection->doses.dose)
		cau_doses_part(dissection, layers);
}

void cau_dissection_lose_element(cau_dissection *dissection, int primitive, int32_t index)
{
	CAU_ASSERT(dissection->doses.dose != NULL, "an element parts where edges do");
	if (primitive != CAU_PRIMITIVE_LINK) {
		cau_doses_lose(dissection, primitive, index);
		return;
	}
	const cau_tissue *tissue = dissection->tissue;
	const int32_t *end = tissue->link + 2 * (size_t)index;
	cau_dissection_lose_edge(dissection, cau_edge_table_find(&tissue->edges, end[0], end[1]),
	                         (uint16_t)(1u << tissue->link_layer[index]));
}

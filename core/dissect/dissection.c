// SPDX-License-Identifier: GPL-3.0-or-later
#include "dissect/dissection.h"

#include <stdbool.h>
#include <string.h>

#include "cautery/assert.h"

_Static_assert(CAU_MAX_LAYERS <= 16, "a bit of `parted` for each layer");

static const double heat_capacity = 3500; // J/(kg K), soft tissue

static int element_kind(int primitive)
{
	CAU_ASSERT_INDEX(primitive, CAU_PRIMITIVE_KINDS);
	static const int kind[CAU_PRIMITIVE_KINDS] = {CAU_ELEMENT_TRIANGLE, CAU_ELEMENT_TETRAHEDRON,
	                                              CAU_ELEMENT_LINK};
	return kind[primitive];
}

static int32_t primitive_count(const cau_tissue *tissue, int primitive)
{
	return cau_tissue_element_count(tissue, element_kind(primitive));
}

// Of all kinds: what can be removed at most.
static int32_t element_total(const cau_tissue *tissue)
{
	int32_t total = 0;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		total += cau_tissue_element_count(tissue, kind);
	return total;
}

static int32_t layer_of(const cau_tissue *tissue, int primitive, int32_t index)
{
	CAU_ASSERT_INDEX(index, primitive_count(tissue, primitive));
	switch (primitive) {
	case CAU_PRIMITIVE_TRIANGLE:
		return tissue->triangle_layer[index];
	case CAU_PRIMITIVE_TETRAHEDRON:
		return tissue->tetrahedron_layer[index];
	default:
		return tissue->link_layer[index];
	}
}

static const cau_heat_material *heat_of(const cau_tissue *tissue, int primitive, int32_t index)
{
	int32_t material = 0;
	if (primitive == CAU_PRIMITIVE_TRIANGLE)
		material = tissue->triangle_material[index];
	else if (primitive == CAU_PRIMITIVE_TETRAHEDRON)
		material = tissue->tetrahedron_material[index];
	return cau_layer_heat(&tissue->layer[layer_of(tissue, primitive, index)], material);
}

static const int32_t *vertices_of(const cau_tissue *tissue, int primitive, int32_t index,
                                  int *count)
{
	CAU_ASSERT_INDEX(index, primitive_count(tissue, primitive));
	*count = primitive == CAU_PRIMITIVE_TRIANGLE      ? 3
	         : primitive == CAU_PRIMITIVE_TETRAHEDRON ? 4
	                                                  : 2;
	const int32_t *base = primitive == CAU_PRIMITIVE_TRIANGLE      ? tissue->triangle
	                      : primitive == CAU_PRIMITIVE_TETRAHEDRON ? tissue->tetrahedron
	                                                               : tissue->link;
	return base + (size_t)*count * (size_t)index;
}

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
                                 uint64_t seed, cau_arena *arena, cau_error *error)
{
	size_t edges = (size_t)tissue->edges.edge_count, faces = (size_t)tissue->faces.face_count,
		   total = 0;
	*dissection = (cau_dissection){.tissue = tissue, .seed = seed};
	bool missing = false;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++) {
		dissection->share_count[p] = cau_arena_array(arena, (size_t)primitive_count(tissue, p), 1);
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
}

// ---- faces
static void draw_face(cau_dissection *dissection, int32_t face)
{
	CAU_ASSERT_INDEX(face, dissection->tissue->faces.face_count);
	const cau_face_table *faces = &dissection->tissue->faces;
	bool drawn = dissection->face_owners[face] == 1;
	if (face >= faces->triangle_count && faces->cover[face] >= 0)
		drawn &= !dissection->alive.element[CAU_ELEMENT_TRIANGLE][faces->cover[face]];
	uint32_t bit = 1u << (face & 31);
	if (drawn)
		dissection->face_mask[face >> 5] &= ~bit;
	else
		dissection->face_mask[face >> 5] |= bit;
}

static void lose_faces(cau_dissection *dissection, int primitive, int32_t index)
{
	const cau_face_table *faces = &dissection->tissue->faces;
	if (primitive == CAU_PRIMITIVE_TRIANGLE) {
		dissection->face_owners[index] = 0;
		draw_face(dissection, index);
		if (faces->triangle_covers[index] >= 0)
			draw_face(dissection, faces->triangle_covers[index]);
	} else if (primitive == CAU_PRIMITIVE_TETRAHEDRON) {
		for (int i = 0; i < 4; i++) {
			int32_t face = faces->tetrahedron_face[4 * (size_t)index + (size_t)i];
			CAU_ASSERT(dissection->face_owners[face] > 0,
			           "face %d loses tetrahedron %d, and has none", face, index);
			dissection->face_owners[face]--;
			draw_face(dissection, face);
		}
	}
}

// ---- exposure
static bool edge_lives(const cau_dissection *dissection, int32_t edge)
{
	CAU_ASSERT_INDEX(edge, dissection->tissue->edges.edge_count);
	const cau_edge_table *edges = &dissection->tissue->edges;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t k = edges->first[p][edge]; k < edges->first[p][edge + 1]; k++)
			if (dissection->alive.element[element_kind(p)][edges->sharer[p][k]])
				return true;
	return false;
}

// An edge's share of the mass at its ends: there are about a dozen edges at a vertex.
static double heat_taken(const cau_dissection *dissection, int32_t edge, double gain)
{
	CAU_ASSERT(gain > 0, "edge %d takes %g degC s", edge, gain);
	const cau_tissue *tissue = dissection->tissue;
	const cau_edge_table *edges = &tissue->edges;
	double absorption = 0;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS && absorption == 0; p++)
		if (edges->first[p][edge] < edges->first[p][edge + 1])
			absorption =
				heat_of(tissue, p, edges->sharer[p][edges->first[p][edge]])->absorption_per_s;
	double mass = tissue->mass[edges->vertex[2 * edge]] + tissue->mass[edges->vertex[2 * edge + 1]];
	return gain * absorption * heat_capacity * mass / 12;
}

// Whether a sphere can reach the segment at all: most edges of a near block are out of it, and the
// temperature at their ends need not be looked up.
static bool in_reach(cau_vec3 a, cau_vec3 b, cau_vec3 center, double radius)
{
	cau_vec3 along = cau_sub(b, a), off = cau_sub(cau_add(a, b), cau_add(center, center));
	double twice = 2 * (radius + 1e-6) + cau_length(along); // a micrometre for rounding
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
			if (!dissection->touched_mark[edge]) {
				dissection->touched_mark[edge] = 1;
				CAU_ASSERT_INDEX(dissection->touched_count, dissection->tissue->edges.edge_count);
				dissection->touched[dissection->touched_count++] = edge;
			}
		}
	}
	return taken;
}

// ---- parting
static void remove_hinges(cau_dissection *dissection, int32_t triangle)
{
	const int32_t *first = dissection->triangle_hinge_first;
	for (int32_t k = first[triangle]; k < first[triangle + 1]; k++) {
		int32_t hinge = dissection->triangle_hinge[k];
		if (!dissection->alive.element[CAU_ELEMENT_HINGE][hinge])
			continue;
		dissection->alive.element[CAU_ELEMENT_HINGE][hinge] = 0;
		CAU_ASSERT_INDEX(hinge, dissection->tissue->hinge_count);
		dissection->removed[dissection->removed_count++] = (cau_removed){CAU_ELEMENT_HINGE, hinge};
	}
}

static void remove_primitive(cau_dissection *dissection, int primitive, int32_t index)
{
	int kind = element_kind(primitive), count;
	CAU_ASSERT(dissection->alive.element[kind][index], "element %d of kind %d is removed twice",
	           index, kind);
	CAU_ASSERT(dissection->removed_count < element_total(dissection->tissue),
	           "%d elements removed of %d", dissection->removed_count,
	           element_total(dissection->tissue));
	dissection->alive.element[kind][index] = 0;
	dissection->elements_removed++;
	dissection->removed[dissection->removed_count++] = (cau_removed){kind, index};
	const int32_t *vertex = vertices_of(dissection->tissue, primitive, index, &count);
	for (int i = 0; i < count; i++) {
		CAU_ASSERT(dissection->live_elements[vertex[i]] > 0,
		           "vertex %d loses element %d of kind %d, and has none", vertex[i], index, kind);
		dissection->live_elements[vertex[i]]--;
	}
	lose_faces(dissection, primitive, index);
	if (primitive == CAU_PRIMITIVE_TRIANGLE)
		remove_hinges(dissection, index);
}

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

// Ignition of an edge in the layer of one of its primitives: exposure is compared as xi times the
// integral.
static bool ignites(const cau_dissection *dissection, int primitive, int32_t index, int32_t edge)
{
	const cau_heat_material *heat = heat_of(dissection->tissue, primitive, index);
	int32_t layer = layer_of(dissection->tissue, primitive, index);
	double ignition = heat->ignition_bundle_m > 0
	                      ? ignition_in_bundles(dissection, heat, layer, edge)
	                      : cau_ignition_of(heat->ignition_c, heat->ignition_spread_c,
	                                        dissection->seed, layer, edge);
	return heat->absorption_per_s * dissection->exposure[edge] > ignition;
}

// Layers in which the edge parts now, as bits; those in which it has parted are left out.
static uint16_t layers_parting(const cau_dissection *dissection, int32_t edge)
{
	const cau_edge_table *edges = &dissection->tissue->edges;
	uint16_t before = dissection->parted[edge], parting = 0;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t k = edges->first[p][edge]; k < edges->first[p][edge + 1]; k++) {
			int32_t index = edges->sharer[p][k];
			uint16_t bit = (uint16_t)(1u << layer_of(dissection->tissue, p, index));
			CAU_ASSERT(bit != 0, "layer %d has no bit", layer_of(dissection->tissue, p, index));
			if (!((before | parting) & bit) && ignites(dissection, p, index, edge))
				parting |= bit;
		}
	return parting;
}

static void part_edge(cau_dissection *dissection, int32_t edge, uint32_t *layers)
{
	CAU_ASSERT_INDEX(edge, dissection->tissue->edges.edge_count);
	const cau_edge_table *edges = &dissection->tissue->edges;
	uint16_t parting = layers_parting(dissection, edge);
	if (!parting)
		return;
	dissection->parted[edge] |= parting;
	dissection->edges_parted++;
	*layers |= parting;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t k = edges->first[p][edge]; k < edges->first[p][edge + 1]; k++) {
			int32_t index = edges->sharer[p][k];
			if (!(parting >> layer_of(dissection->tissue, p, index) & 1))
				continue;
			CAU_ASSERT(dissection->share_count[p][index] > 0,
			           "primitive %d of kind %d loses edge %d, and has none", index, p, edge);
			dissection->share_count[p][index]--;
			if (dissection->alive.element[element_kind(p)][index])
				remove_primitive(dissection, p, index);
		}
}

void cau_dissection_part(cau_dissection *dissection, uint32_t *layers)
{
	for (int32_t k = 0; k < dissection->touched_count; k++)
		part_edge(dissection, dissection->touched[k], layers);
}

double cau_dissection_heated(const cau_dissection *dissection, int32_t edge)
{
	CAU_ASSERT_INDEX(edge, dissection->tissue->edges.edge_count);
	const cau_edge_table *edges = &dissection->tissue->edges;
	double most = 0;
	if (dissection->exposure[edge] <= 0)
		return 0;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++) {
		int32_t k = edges->first[p][edge];
		if (k == edges->first[p][edge + 1])
			continue;
		const cau_heat_material *heat = heat_of(dissection->tissue, p, edges->sharer[p][k]);
		most = fmax(most, heat->absorption_per_s * dissection->exposure[edge] / heat->ignition_c);
	}
	return fmin(most, 1);
}

// ---- recount
static void recount_shares(cau_dissection *dissection)
{
	static const uint8_t edges_of[CAU_PRIMITIVE_KINDS] = {3, 6, 1};
	const cau_edge_table *edges = &dissection->tissue->edges;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		memset(dissection->share_count[p], edges_of[p],
		       (size_t)primitive_count(dissection->tissue, p));
	for (int32_t e = 0; e < edges->edge_count; e++)
		for (int p = 0; p < CAU_PRIMITIVE_KINDS && dissection->parted[e]; p++)
			for (int32_t k = edges->first[p][e]; k < edges->first[p][e + 1]; k++) {
				int32_t index = edges->sharer[p][k];
				if (!(dissection->parted[e] >> layer_of(dissection->tissue, p, index) & 1))
					continue;
				CAU_ASSERT(dissection->share_count[p][index] > 0,
				           "primitive %d of kind %d loses edge %d, and has none", index, p, e);
				dissection->share_count[p][index]--;
			}
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t i = 0; i < primitive_count(dissection->tissue, p); i++)
			dissection->alive.element[element_kind(p)][i] =
				dissection->share_count[p][i] == edges_of[p];
}

static void recount_hinges(cau_dissection *dissection)
{
	const cau_tissue *tissue = dissection->tissue;
	const uint8_t *triangle = dissection->alive.element[CAU_ELEMENT_TRIANGLE];
	for (int32_t h = 0; h < tissue->hinge_count; h++)
		dissection->alive.element[CAU_ELEMENT_HINGE][h] =
			triangle[tissue->hinge_triangle[2 * h]] & triangle[tissue->hinge_triangle[2 * h + 1]];
}

static void recount_faces(cau_dissection *dissection)
{
	const cau_tissue *tissue = dissection->tissue;
	const cau_face_table *faces = &tissue->faces;
	memset(dissection->live_elements, 0, (size_t)tissue->vertex_count * sizeof(int32_t));
	memset(dissection->face_owners, 0, (size_t)faces->face_count);
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t i = 0; i < primitive_count(tissue, p); i++) {
			if (!dissection->alive.element[element_kind(p)][i])
				continue;
			int count;
			const int32_t *vertex = vertices_of(tissue, p, i, &count);
			for (int k = 0; k < count; k++)
				dissection->live_elements[vertex[k]]++;
			if (p == CAU_PRIMITIVE_TRIANGLE)
				dissection->face_owners[i] = 1;
			for (int k = 0; k < 4 && p == CAU_PRIMITIVE_TETRAHEDRON; k++)
				dissection->face_owners[faces->tetrahedron_face[4 * (size_t)i + (size_t)k]]++;
			CAU_ASSERT(dissection->live_elements[vertex[0]] > 0,
			           "vertex %d of living tetrahedron %d has no element", vertex[0], i);
		}
	for (int32_t f = 0; f < faces->face_count; f++)
		draw_face(dissection, f);
}

void cau_dissection_recount(cau_dissection *dissection)
{
	recount_shares(dissection);
	recount_hinges(dissection);
	recount_faces(dissection);
}

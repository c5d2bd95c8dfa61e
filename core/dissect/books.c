// SPDX-License-Identifier: GPL-3.0-or-later
// The books of dissection: the heat material of a primitive, the heated share of an edge, live
// primitives, and drawn faces. Also removes an edge or an element, and computes all of these again
// from the parted edges.
#include <string.h>

#include "cautery/assert.h"
#include "dissect/dissection_internal.h"

// Returns the number of elements of all kinds: the most that can be removed.
static int32_t element_total(const cau_tissue *tissue)
{
	int32_t total = 0;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		total += cau_tissue_element_count(tissue, kind);
	return total;
}

const cau_heat_material *cau_dissection_heat_of(const cau_tissue *tissue, int primitive,
                                                int32_t index)
{
	int32_t material = 0;
	if (primitive == CAU_PRIMITIVE_TRIANGLE)
		material = tissue->triangle_material[index];
	else if (primitive == CAU_PRIMITIVE_TETRAHEDRON)
		material = tissue->tetrahedron_material[index];
	return cau_layer_heat(&tissue->layer[cau_tissue_layer_of(tissue, primitive, index)], material);
}

// Returns the heat material of the first primitive of a kind at the edge; NULL if there is none.
static const cau_heat_material *heat_at(const cau_dissection *dissection, int primitive,
                                        int32_t edge)
{
	CAU_ASSERT_INDEX(edge, dissection->tissue->edges.edge_count);
	const cau_edge_table *edges = &dissection->tissue->edges;
	int32_t k = edges->first[primitive][edge];
	if (k == edges->first[primitive][edge + 1])
		return NULL;
	return cau_dissection_heat_of(dissection->tissue, primitive, edges->sharer[primitive][k]);
}

// Raises the edge's exposure to the largest exposure that one of its materials needs for this
// share.
void cau_dissection_show_heated(cau_dissection *dissection, int32_t edge, double share)
{
	double exposure = dissection->exposure[edge];
	CAU_ASSERT(share >= 0 && share <= 1, "edge %d is heated by %g", edge, share);
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++) {
		const cau_heat_material *heat = heat_at(dissection, p, edge);
		if (heat && heat->absorption_per_s > 0)
			exposure = fmax(exposure, share * heat->ignition_c / heat->absorption_per_s);
	}
	if (exposure > dissection->exposure[edge])
		cau_dissection_touch(dissection, edge);
	dissection->exposure[edge] = exposure;
}

double cau_dissection_heated(const cau_dissection *dissection, int32_t edge)
{
	double most = 0;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS && dissection->exposure[edge] > 0; p++) {
		const cau_heat_material *heat = heat_at(dissection, p, edge);
		if (heat)
			most =
				fmax(most, heat->absorption_per_s * dissection->exposure[edge] / heat->ignition_c);
	}
	return fmin(most, 1);
}

bool cau_dissection_lives(const cau_dissection *dissection, int primitive, int32_t index)
{
	CAU_ASSERT_INDEX(index, cau_tissue_element_count(dissection->tissue, primitive));
	return dissection->alive.element[primitive][index];
}

void cau_dissection_touch(cau_dissection *dissection, int32_t edge)
{
	if (dissection->touched_mark[edge])
		return;
	dissection->touched_mark[edge] = 1;
	CAU_ASSERT_INDEX(dissection->touched_count, dissection->tissue->edges.edge_count);
	dissection->touched[dissection->touched_count++] = edge;
}

int32_t cau_doses_place(const cau_tissue *tissue, int primitive, int32_t index)
{
	CAU_ASSERT(primitive < CAU_PRIMITIVE_LINK, "links have no dose");
	return primitive == CAU_PRIMITIVE_TRIANGLE ? index : tissue->triangle_count + index;
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

void cau_dissection_remove(cau_dissection *dissection, int primitive, int32_t index)
{
	int count;
	CAU_ASSERT(dissection->alive.element[primitive][index],
	           "element %d of kind %d is removed twice", index, primitive);
	CAU_ASSERT(dissection->removed_count < element_total(dissection->tissue),
	           "%d elements removed of %d", dissection->removed_count,
	           element_total(dissection->tissue));
	dissection->alive.element[primitive][index] = 0;
	dissection->elements_removed++;
	dissection->removed[dissection->removed_count++] = (cau_removed){primitive, index};
	const int32_t *vertex = cau_tissue_vertices_of(dissection->tissue, primitive, index, &count);
	for (int i = 0; i < count; i++) {
		CAU_ASSERT(dissection->live_elements[vertex[i]] > 0,
		           "vertex %d loses element %d of kind %d, and has none", vertex[i], index,
		           primitive);
		dissection->live_elements[vertex[i]]--;
	}
	lose_faces(dissection, primitive, index);
	if (primitive == CAU_PRIMITIVE_TRIANGLE)
		remove_hinges(dissection, index);
}

void cau_dissection_lose_edge(cau_dissection *dissection, int32_t edge, uint16_t layers)
{
	const cau_edge_table *edges = &dissection->tissue->edges;
	CAU_ASSERT_INDEX(edge, edges->edge_count);
	CAU_ASSERT(!(dissection->parted[edge] & layers), "edge %d parts again", edge);
	dissection->parted[edge] |= layers;
	dissection->edges_parted++;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t k = edges->first[p][edge]; k < edges->first[p][edge + 1]; k++) {
			int32_t index = edges->sharer[p][k];
			if (!(layers >> cau_tissue_layer_of(dissection->tissue, p, index) & 1))
				continue;
			CAU_ASSERT(dissection->share_count[p][index] > 0,
			           "primitive %d of kind %d loses edge %d, and has none", index, p, edge);
			dissection->share_count[p][index]--;
			if (cau_dissection_lives(dissection, p, index))
				cau_dissection_remove(dissection, p, index);
		}
}

// ---- recount

// Clears `alive` for elements at parted edges.
static void mark_parted(const cau_tissue *tissue, const uint16_t *parted,
                        uint8_t *const alive[CAU_ELEMENT_KINDS])
{
	const cau_edge_table *edges = &tissue->edges;
	for (int32_t e = 0; e < edges->edge_count; e++)
		for (int p = 0; p < CAU_PRIMITIVE_KINDS && parted[e]; p++)
			for (int32_t k = edges->first[p][e]; k < edges->first[p][e + 1]; k++) {
				int32_t index = edges->sharer[p][k];
				if (parted[e] >> cau_tissue_layer_of(tissue, p, index) & 1)
					alive[p][index] = 0;
			}
}

void cau_dissection_find_alive(const cau_tissue *tissue, const uint16_t *parted,
                               const uint8_t *gone, uint8_t *const alive[CAU_ELEMENT_KINDS])
{
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t i = 0; i < cau_tissue_element_count(tissue, p); i++)
			alive[p][i] = !gone || p == CAU_PRIMITIVE_LINK || !gone[cau_doses_place(tissue, p, i)];
	mark_parted(tissue, parted, alive);
	const uint8_t *triangle = alive[CAU_ELEMENT_TRIANGLE];
	for (int32_t h = 0; h < tissue->hinge_count; h++)
		alive[CAU_ELEMENT_HINGE][h] =
			triangle[tissue->hinge_triangle[2 * h]] & triangle[tissue->hinge_triangle[2 * h + 1]];
}

static void recount_shares(cau_dissection *dissection)
{
	static const uint8_t edges_of[CAU_PRIMITIVE_KINDS] = {3, 6, 1};
	const cau_edge_table *edges = &dissection->tissue->edges;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		memset(dissection->share_count[p], edges_of[p],
		       (size_t)cau_tissue_element_count(dissection->tissue, p));
	for (int32_t e = 0; e < edges->edge_count; e++)
		for (int p = 0; p < CAU_PRIMITIVE_KINDS && dissection->parted[e]; p++)
			for (int32_t k = edges->first[p][e]; k < edges->first[p][e + 1]; k++) {
				int32_t index = edges->sharer[p][k];
				if (!(dissection->parted[e] >> cau_tissue_layer_of(dissection->tissue, p, index) &
				      1))
					continue;
				CAU_ASSERT(dissection->share_count[p][index] > 0,
				           "primitive %d of kind %d loses edge %d, and has none", index, p, e);
				dissection->share_count[p][index]--;
			}
}

static void recount_faces(cau_dissection *dissection)
{
	const cau_tissue *tissue = dissection->tissue;
	const cau_face_table *faces = &tissue->faces;
	memset(dissection->live_elements, 0, (size_t)tissue->vertex_count * sizeof(int32_t));
	memset(dissection->face_owners, 0, (size_t)faces->face_count);
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t i = 0; i < cau_tissue_element_count(tissue, p); i++) {
			if (!dissection->alive.element[p][i])
				continue;
			int count;
			const int32_t *vertex = cau_tissue_vertices_of(tissue, p, i, &count);
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
	cau_dissection_find_alive(dissection->tissue, dissection->parted, dissection->doses.gone,
	                          dissection->alive.element);
	recount_faces(dissection);
}

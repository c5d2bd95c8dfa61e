// SPDX-License-Identifier: GPL-3.0-or-later
#include "constraint/pairs.h"

#include "cautery/assert.h"

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

// SPDX-License-Identifier: GPL-3.0-or-later
// Links between a sheet and the layer under it (section 5.2, last paragraph). Each vertex of the
// upper layer is linked to the nearest vertices of the lower layer within reach. Several links at a
// vertex resist shear as well.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "tissue/tissue_internal.h"

enum { MAX_PER_VERTEX = 8 };

// Marks the vertices that the layer's elements use.
static void mark_layer(const cau_tissue *tissue, int32_t layer_index, uint8_t *mark)
{
	CAU_ASSERT_INDEX(layer_index, tissue->layer_count);
	const cau_tissue_layer *layer = &tissue->layer[layer_index];
	memset(mark, 0, (size_t)tissue->vertex_count);
	for (int32_t i = 3 * layer->first_triangle;
	     i < 3 * (layer->first_triangle + layer->triangle_count); i++)
		mark[tissue->triangle[i]] = 1;
	for (int32_t i = 4 * layer->first_tetrahedron;
	     i < 4 * (layer->first_tetrahedron + layer->tetrahedron_count); i++)
		mark[tissue->tetrahedron[i]] = 1;
}

// A vertex of the lower layer. Candidates are sorted by x. A search starts at the x of the upper
// layer's vertex and goes outwards. The search ends where the distance in x alone is too large.
typedef struct candidate {
	double x;
	int32_t vertex;
} candidate;

static int compare_candidates(const void *a, const void *b)
{
	const candidate *one = a, *two = b;
	if (one->x != two->x)
		return one->x < two->x ? -1 : 1;
	return (one->vertex > two->vertex) - (one->vertex < two->vertex);
}

static int32_t first_at_or_after(const candidate *lower, int32_t count, double x)
{
	int32_t low = 0, high = count;
	while (low < high) {
		int32_t middle = low + (high - low) / 2;
		if (lower[middle].x < x)
			low = middle + 1;
		else
			high = middle;
	}
	CAU_ASSERT(low >= 0 && low <= count, "place %d of %d", low, count);
	return low;
}

static bool is_nearer(double distance, int32_t vertex, double than, int32_t than_vertex)
{
	return distance < than || (distance == than && vertex < than_vertex);
}

// Finds the nearest vertices to `from` within reach, nearest first, equal distances by number.
// Returns how many there are.
static int32_t nearest(const cau_tissue *tissue, int32_t from, const candidate *lower,
                       int32_t lower_count, double reach, int32_t most, int32_t *found)
{
	CAU_ASSERT(most >= 1 && most <= MAX_PER_VERTEX, "%d links from a vertex", most);
	CAU_ASSERT_INDEX(from, tissue->vertex_count);
	double distance[MAX_PER_VERTEX] = {0};
	int32_t count = 0;
	cau_vec3 x = cau_vec3_of(tissue->rest + 3 * (size_t)from);
	int32_t right = first_at_or_after(lower, lower_count, x.x), left = right - 1;
	for (;;) {
		double ahead = right < lower_count ? lower[right].x - x.x : INFINITY;
		double behind = left >= 0 ? x.x - lower[left].x : INFINITY;
		if (fmin(ahead, behind) > (count && count == most ? distance[count - 1] : reach))
			return count;
		int32_t vertex = ahead <= behind ? lower[right++].vertex : lower[left--].vertex;
		CAU_ASSERT(right <= lower_count && left >= -1, "from %d to %d of %d candidates", left,
		           right, lower_count);
		double d = cau_length(cau_sub(cau_vec3_of(tissue->rest + 3 * (size_t)vertex), x));
		if (vertex == from || d > reach ||
		    (count == most && !is_nearer(d, vertex, distance[count - 1], found[count - 1])))
			continue;
		int32_t k = count < most ? count++ : count - 1;
		for (; k > 0 && is_nearer(d, vertex, distance[k - 1], found[k - 1]); k--) {
			distance[k] = distance[k - 1];
			found[k] = found[k - 1];
		}
		distance[k] = d;
		found[k] = vertex;
	}
}

static cau_status link_layers(cau_tissue *tissue, int32_t index, uint8_t *mark, candidate *lower,
                              int32_t capacity, cau_error *error)
{
	cau_tissue_layer *layer = &tissue->layer[index];
	const cau_link_material *material = &layer->def.link;
	int32_t of = cau_tissue_find_layer(tissue, layer->def.of);
	int32_t to = cau_tissue_find_layer(tissue, layer->def.to);
	CAU_ASSERT(of >= 0 && to >= 0, "layer %d links layers that are not there", index);
	mark_layer(tissue, to, mark);
	int32_t lower_count = 0;
	for (int32_t v = 0; v < tissue->vertex_count; v++)
		if (mark[v])
			lower[lower_count++] = (candidate){tissue->rest[3 * (size_t)v], v};
	qsort(lower, (size_t)lower_count, sizeof *lower, compare_candidates);
	mark_layer(tissue, of, mark);
	layer->first_link = tissue->link_count;
	for (int32_t v = 0; v < tissue->vertex_count; v++) {
		int32_t found[MAX_PER_VERTEX];
		if (!mark[v])
			continue;
		int32_t count = nearest(tissue, v, lower, lower_count, material->reach_m,
		                        (int32_t)material->per_vertex, found);
		for (int32_t i = 0; i < count && tissue->link_count < capacity; i++) {
			int32_t k = tissue->link_count++;
			tissue->link[2 * k] = v;
			tissue->link[2 * k + 1] = found[i];
			tissue->link_layer[k] = index;
			tissue->link_length[k] =
				cau_length(cau_sub(cau_vec3_of(tissue->rest + 3 * (size_t)v),
			                       cau_vec3_of(tissue->rest + 3 * (size_t)found[i])));
		}
	}
	layer->link_count = tissue->link_count - layer->first_link;
	char path[64];
	snprintf(path, sizeof path, "layers[%d].reach_m", index);
	if (!layer->link_count)
		return cau_fail(error, CAU_BAD_VALUE, path, "no vertex of \"%s\" is within %g m of \"%s\"",
		                layer->def.of, material->reach_m, layer->def.to);
	return CAU_OK;
}

cau_status cau_tissue_link(cau_tissue *tissue, cau_arena *arena, cau_error *error)
{
	int64_t capacity = 0;
	for (int32_t i = 0; i < tissue->layer_count; i++)
		if (tissue->layer[i].def.kind == CAU_LAYER_LINKS)
			capacity +=
				(int64_t)tissue->vertex_count * (int64_t)tissue->layer[i].def.link.per_vertex;
	if (capacity > INT32_MAX / 2)
		return cau_fail(error, CAU_LIMIT, NULL, "this scene would need %lld links",
		                (long long)capacity);
	cau_arena scratch = {0};
	uint8_t *mark = cau_arena_array(&scratch, (size_t)tissue->vertex_count, 1);
	candidate *lower = cau_arena_array(&scratch, (size_t)tissue->vertex_count, sizeof *lower);
	tissue->link = cau_arena_array(arena, 2 * (size_t)capacity, sizeof(int32_t));
	tissue->link_layer = cau_arena_array(arena, (size_t)capacity, sizeof(int32_t));
	tissue->link_length = cau_arena_array(arena, (size_t)capacity, sizeof(double));
	cau_status status = CAU_OK;
	if (!mark || !lower || !tissue->link || !tissue->link_layer || !tissue->link_length)
		status =
			cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %lld links", (long long)capacity);
	for (int32_t i = 0; i < tissue->layer_count && !status; i++)
		if (tissue->layer[i].def.kind == CAU_LAYER_LINKS)
			status = link_layers(tissue, i, mark, lower, (int32_t)capacity, error);
	cau_arena_finish(&scratch);
	return status;
}

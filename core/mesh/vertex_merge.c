// SPDX-License-Identifier: GPL-3.0-or-later
// Merges vertices with a spatial hash. Its cells have the width `distance`. Only kept vertices are
// entered. They are farther than `distance` from each other, so a cell holds few of them.
#include "mesh/mesh.h"

#include <math.h>

#include "cautery/assert.h"

static const double near = 1e-5; // share of the bounding diagonal within which vertices merge

typedef struct grid {
	const double *position;
	const double *origin;
	double distance;
	int32_t *bucket; // (mask + 1): the vertex that was entered last, or -1
	int32_t *next;   // (vertex_count): the vertex entered before in the same bucket, or -1
	uint64_t mask;
} grid;

static void cell_of(const grid *g, int32_t vertex, int64_t cell[3])
{
	for (size_t c = 0; c < 3; c++)
		cell[c] = (int64_t)((g->position[3 * (size_t)vertex + c] - g->origin[c]) / g->distance);
	CAU_ASSERT(cell[0] >= 0, "vertex %d lies before the origin", vertex);
}

static uint64_t bucket_of(const grid *g, const int64_t cell[3])
{
	uint64_t hash = 0;
	for (int c = 0; c < 3; c++) {
		hash = (hash ^ (uint64_t)cell[c]) * UINT64_C(0x9e3779b97f4a7c15);
		hash ^= hash >> 29;
	}
	return hash & g->mask;
}

static bool is_near(const grid *g, int32_t a, int32_t b)
{
	double square = 0;
	for (size_t c = 0; c < 3; c++) {
		double d = g->position[3 * (size_t)a + c] - g->position[3 * (size_t)b + c];
		square += d * d;
	}
	return square < g->distance * g->distance;
}

// Returns the lowest entered vertex that is near `vertex`, or `vertex` itself. Searches the cell of
// `vertex` and the 26 cells around.
static int32_t find_near(const grid *g, int32_t vertex, const int64_t cell[3])
{
	int32_t lowest = vertex;
	for (int i = 0; i < 27; i++) {
		const int64_t beside[3] = {cell[0] + i / 9 - 1, cell[1] + i / 3 % 3 - 1,
		                           cell[2] + i % 3 - 1};
		for (int32_t v = g->bucket[bucket_of(g, beside)]; v >= 0; v = g->next[v])
			if (v < lowest && is_near(g, v, vertex))
				lowest = v;
	}
	CAU_ASSERT(lowest >= 0 && lowest <= vertex, "vertex %d becomes %d", vertex, lowest);
	return lowest;
}

static void enter(grid *g, int32_t vertex, const int64_t cell[3])
{
	CAU_ASSERT(vertex >= 0, "vertex %d", vertex);
	int32_t *bucket = g->bucket + bucket_of(g, cell);
	g->next[vertex] = *bucket;
	*bucket = vertex;
}

// Fills map (vertex_count). Each vertex is mapped to the lowest kept vertex that is nearer than
// `distance` (above zero), or to itself. `position` (vertex_count x 3) is at most 1e15 distances
// above `origin`. O(vertex_count). Returns false if memory ran out.
static bool merge(const double *position, int32_t vertex_count, const double origin[3],
                  double distance, int32_t *map)
{
	CAU_ASSERT(distance > 0 && vertex_count >= 0, "%d vertices nearer than %g m", vertex_count,
	           distance);
	grid g = {.position = position, .origin = origin, .distance = distance, .mask = 63};
	while (g.mask < 2 * (uint64_t)vertex_count)
		g.mask = 2 * g.mask + 1;
	g.bucket = cau_mesh_array((size_t)g.mask + 1, sizeof *g.bucket);
	g.next = cau_mesh_array((size_t)vertex_count, sizeof *g.next);
	bool done = g.bucket && g.next;
	for (uint64_t b = 0; done && b <= g.mask; b++)
		g.bucket[b] = -1;
	for (int32_t v = 0; done && v < vertex_count; v++) {
		int64_t cell[3];
		cell_of(&g, v, cell);
		map[v] = find_near(&g, v, cell);
		if (map[v] == v)
			enter(&g, v, cell);
	}
	free(g.bucket);
	free(g.next);
	return done;
}

bool cau_vertex_merge_near(const double *position, int32_t vertex_count, int32_t *map)
{
	double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (size_t i = 0; i < 3 * (size_t)vertex_count; i++) {
		least[i % 3] = fmin(least[i % 3], position[i]);
		most[i % 3] = fmax(most[i % 3], position[i]);
	}
	double diagonal = hypot(hypot(most[0] - least[0], most[1] - least[1]), most[2] - least[2]);
	if (diagonal > 0 && isfinite(diagonal))
		return merge(position, vertex_count, least, near * diagonal, map);
	for (int32_t v = 0; v < vertex_count; v++)
		map[v] = v;
	return true;
}

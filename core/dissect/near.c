// SPDX-License-Identifier: GPL-3.0-or-later
#include "dissect/near.h"

#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"

typedef struct keyed {
	uint32_t key;
	int32_t vertex;
} keyed;

static int compare(const void *a, const void *b)
{
	const keyed *x = a, *y = b;
	if (x->key != y->key)
		return x->key < y->key ? -1 : 1;
	return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static void morton_order(const cau_tissue *tissue, keyed *order)
{
	double least[3] = {1e300, 1e300, 1e300}, most = 0;
	for (int32_t i = 0; i < 3 * tissue->vertex_count; i++)
		least[i % 3] = fmin(least[i % 3], tissue->rest[i]);
	for (int32_t i = 0; i < 3 * tissue->vertex_count; i++)
		most = fmax(most, tissue->rest[i] - least[i % 3]);
	for (int32_t v = 0; v < tissue->vertex_count; v++) {
		double unit[3] = {0};
		for (size_t c = 0; c < 3 && most > 0; c++)
			unit[c] = (tissue->rest[3 * (size_t)v + c] - least[c]) / most;
		order[v] = (keyed){cau_morton(unit), v};
	}
	qsort(order, (size_t)tissue->vertex_count, sizeof *order, compare);
}

// Assigns each edge to the block of its first vertex. The second vertices of a block's edges are
// the block's halo.
static void own_edges(cau_near *near, const cau_tissue *tissue, const int32_t *block_of)
{
	const cau_edge_table *edges = &tissue->edges;
	for (int32_t e = 0; e < edges->edge_count; e++)
		near->edge_first[block_of[edges->vertex[2 * e]] + 1]++;
	for (int32_t b = 0; b < near->block_count; b++)
		near->edge_first[b + 1] += near->edge_first[b];
	memcpy(near->halo_first, near->edge_first, (size_t)(near->block_count + 1) * sizeof(int32_t));
	for (int32_t e = 0; e < edges->edge_count; e++) {
		int32_t at = near->halo_first[block_of[edges->vertex[2 * e]]]++;
		CAU_ASSERT_INDEX(at, edges->edge_count);
		near->edge[at] = e;
		near->halo[at] = edges->vertex[2 * e + 1];
	}
	memcpy(near->halo_first, near->edge_first, (size_t)(near->block_count + 1) * sizeof(int32_t));
}

static int32_t least_vertex(const cau_face_table *faces, int32_t face)
{
	const int32_t *v = faces->vertex + 3 * (size_t)face;
	int32_t least = v[0] < v[1] ? v[0] : v[1];
	return least < v[2] ? least : v[2];
}

// Assigns each face to the block of its vertex with the least index. That block owns two edges of
// the face, so the other two vertices are in the block's halo.
static void own_faces(cau_near *near, const cau_face_table *faces, const int32_t *block_of)
{
	for (int32_t f = 0; f < faces->face_count; f++)
		near->face_first[block_of[least_vertex(faces, f)] + 1]++;
	for (int32_t b = 0; b < near->block_count; b++)
		near->face_first[b + 1] += near->face_first[b];
	// Each block's range is filled from its end back to its start.
	for (int32_t f = faces->face_count; f-- > 0;) {
		int32_t at = --near->face_first[block_of[least_vertex(faces, f)] + 1];
		CAU_ASSERT_INDEX(at, faces->face_count);
		near->face[at] = f;
	}
	for (int32_t b = 0; b < near->block_count; b++)
		near->face_first[b] = near->face_first[b + 1];
	near->face_first[near->block_count] = faces->face_count;
}

static int compare_index(const void *a, const void *b)
{
	int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
	return (x > y) - (x < y);
}

// Removes repeated halo vertices in each block.
static void thin_halo(cau_near *near)
{
	int32_t to = 0;
	for (int32_t b = 0; b < near->block_count; b++) {
		int32_t first = near->halo_first[b], last = near->edge_first[b + 1], start = to;
		CAU_ASSERT(to <= first && first <= last, "block %d has halo %d to %d, written from %d on",
		           b, first, last, to);
		qsort(near->halo + first, (size_t)(last - first), sizeof *near->halo, compare_index);
		for (int32_t k = first; k < last; k++)
			if (to == start || near->halo[to - 1] != near->halo[k])
				near->halo[to++] = near->halo[k];
		near->halo_first[b] = start;
	}
	near->halo_first[near->block_count] = to;
}

cau_status cau_near_create(cau_near *near, const cau_tissue *tissue, cau_arena *arena,
                           cau_error *error)
{
	size_t n = (size_t)tissue->vertex_count, e = (size_t)tissue->edges.edge_count;
	near->vertex_count = tissue->vertex_count;
	near->block_count = (tissue->vertex_count + CAU_NEAR_BLOCK - 1) / CAU_NEAR_BLOCK;
	size_t blocks = (size_t)near->block_count;
	cau_arena scratch = {0};
	keyed *order = cau_arena_array(&scratch, n, sizeof *order);
	int32_t *block_of = cau_arena_array(&scratch, n, sizeof *block_of);
	near->vertex = cau_arena_array(arena, n, sizeof(int32_t));
	near->halo_first = cau_arena_array(arena, blocks + 1, sizeof(int32_t));
	near->halo = cau_arena_array(arena, e, sizeof(int32_t));
	near->edge_first = cau_arena_array(arena, blocks + 1, sizeof(int32_t));
	near->edge = cau_arena_array(arena, e, sizeof(int32_t));
	near->face_first = cau_arena_array(arena, blocks + 1, sizeof(int32_t));
	near->face = cau_arena_array(arena, (size_t)tissue->faces.face_count, sizeof(int32_t));
	near->vertex_box = cau_arena_array(arena, blocks, sizeof(cau_box));
	near->edge_box = cau_arena_array(arena, blocks, sizeof(cau_box));
	cau_status status = CAU_OK;
	if (!order || !block_of || !near->vertex || !near->halo_first || !near->halo ||
	    !near->edge_first || !near->edge || !near->face_first || !near->face || !near->vertex_box ||
	    !near->edge_box) {
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the broad phase");
	} else {
		morton_order(tissue, order);
		for (int32_t i = 0; i < tissue->vertex_count; i++) {
			near->vertex[i] = order[i].vertex;
			block_of[order[i].vertex] = i / CAU_NEAR_BLOCK;
		}
		own_edges(near, tissue, block_of);
		thin_halo(near);
		own_faces(near, &tissue->faces, block_of);
	}
	cau_arena_finish(&scratch);
	return status;
}

// A box in double, until it is complete. Rounding to float does not change the order of
// coordinates, but costs more than their comparison.
typedef struct bounds {
	double least[3], most[3];
} bounds;

static inline bounds grow(bounds b, const double *x)
{
	for (int c = 0; c < 3; c++) {
		b.least[c] = x[c] < b.least[c] ? x[c] : b.least[c];
		b.most[c] = x[c] > b.most[c] ? x[c] : b.most[c];
	}
	return b;
}

static inline bounds grow_round(bounds b, const int32_t *vertex, int32_t count,
                                const double *position)
{
	for (int32_t i = 0; i < count; i++)
		b = grow(b, position + 3 * (size_t)vertex[i]);
	return b;
}

static cau_box box_of(bounds b)
{
	cau_box box;
	for (int c = 0; c < 3; c++) {
		box.least[c] = (float)b.least[c];
		box.most[c] = (float)b.most[c];
	}
	return box;
}

static bounds bounds_of(const cau_box *box)
{
	bounds b;
	for (int c = 0; c < 3; c++) {
		b.least[c] = (double)box->least[c];
		b.most[c] = (double)box->most[c];
	}
	return b;
}

// Returns the number of the block's own vertices.
static int32_t own_count(const cau_near *near, int32_t block)
{
	int32_t left = near->vertex_count - block * CAU_NEAR_BLOCK;
	CAU_ASSERT(left > 0, "block %d is empty", block);
	return left < CAU_NEAR_BLOCK ? left : CAU_NEAR_BLOCK;
}

void cau_near_refit(cau_near *near, const double *position)
{
	for (int32_t block = 0; block < near->block_count; block++) {
		bounds b = {{1e30, 1e30, 1e30}, {-1e30, -1e30, -1e30}};
		b = grow_round(b, near->vertex + block * CAU_NEAR_BLOCK, own_count(near, block), position);
		near->vertex_box[block] = box_of(b);
		int32_t first = near->halo_first[block], last = near->halo_first[block + 1];
		b = grow_round(b, near->halo + first, last - first, position);
		near->edge_box[block] = box_of(b);
	}
}

void cau_near_cover(cau_near *near, const double *position)
{
	for (int32_t block = 0; block < near->block_count; block++) {
		bounds b = bounds_of(&near->vertex_box[block]);
		b = grow_round(b, near->vertex + block * CAU_NEAR_BLOCK, own_count(near, block), position);
		near->vertex_box[block] = box_of(b);
	}
}

bool cau_box_meets(const cau_box *box, cau_vec3 center, double radius_m)
{
	CAU_ASSERT(!(radius_m < 0), "a ball of %g m", radius_m);
	const double c[3] = {center.x, center.y, center.z};
	double squared = 0;
	for (int i = 0; i < 3; i++) {
		double below = (double)box->least[i] - c[i], above = c[i] - (double)box->most[i];
		double outside = below > above ? below : above; // fmax would be a library call
		squared += outside > 0 ? outside * outside : 0;
	}
	double reach = radius_m + 1e-6; // enlarged for rounding: boxes are in float
	return squared <= reach * reach;
}

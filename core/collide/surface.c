// SPDX-License-Identifier: GPL-3.0-or-later
#include "collide/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

typedef struct keyed {
	uint32_t key;
	int32_t face;
} keyed;

static uint32_t spread_bits(uint32_t x) // 10 bits to every third
{
	CAU_ASSERT(x < 1u << 10, "%u has more than 10 bits", x);
	x = (x | x << 16) & 0x030000ffu;
	x = (x | x << 8) & 0x0300f00fu;
	x = (x | x << 4) & 0x030c30c3u;
	return (x | x << 2) & 0x09249249u;
}

static int compare(const void *a, const void *b)
{
	const keyed *x = a, *y = b;
	if (x->key != y->key)
		return x->key < y->key ? -1 : 1;
	return (x->face > y->face) - (x->face < y->face);
}

// Along a Morton curve through the faces' middles at rest.
static void order_faces(const cau_tissue *tissue, keyed *key, int32_t *order)
{
	double least[3] = {1e300, 1e300, 1e300}, most = 0;
	for (int32_t i = 0; i < 3 * tissue->vertex_count; i++)
		least[i % 3] = fmin(least[i % 3], tissue->rest[i]);
	for (int32_t i = 0; i < 3 * tissue->vertex_count; i++)
		most = fmax(most, tissue->rest[i] - least[i % 3]);
	for (int32_t f = 0; f < tissue->faces.face_count; f++) {
		key[f] = (keyed){0, f};
		for (size_t c = 0; c < 3 && most > 0; c++) {
			double middle = 0;
			for (size_t k = 0; k < 3; k++)
				middle += tissue->rest[3 * (size_t)tissue->faces.vertex[3 * (size_t)f + k] + c] / 3;
			double unit = fmin(fmax((middle - least[c]) / most, 0), 1);
			key[f].key |= spread_bits((uint32_t)(unit * 1023)) << c;
		}
	}
	qsort(key, (size_t)tissue->faces.face_count, sizeof *key, compare);
	for (int32_t f = 0; f < tissue->faces.face_count; f++)
		order[f] = key[f].face;
}

static bool make_parts(cau_surface_parts *parts, int32_t most, int32_t most_blocks,
                       cau_arena *arena)
{
	parts->item = cau_arena_array(arena, (size_t)most, sizeof(int32_t));
	parts->first = cau_arena_array(arena, (size_t)most_blocks + 1, sizeof(int32_t));
	return parts->item && parts->first;
}

cau_status cau_surface_create(cau_surface *surface, const cau_tissue *tissue, cau_arena *arena,
                              cau_error *error)
{
	size_t faces = (size_t)tissue->faces.face_count;
	surface->tissue = tissue;
	surface->most_blocks = (tissue->faces.face_count + CAU_SURFACE_BLOCK - 1) / CAU_SURFACE_BLOCK;
	surface->order = cau_arena_array(arena, faces, sizeof(int32_t));
	surface->face_edge = cau_arena_array(arena, 3 * faces, sizeof(int32_t));
	surface->edge_seen = cau_arena_array(arena, (size_t)tissue->edges.edge_count, 1);
	surface->vertex_seen = cau_arena_array(arena, (size_t)tissue->vertex_count, 1);
	surface->mask = cau_arena_array(arena, (faces + 31) / 32, sizeof(uint32_t));
	bool made = make_parts(&surface->faces, tissue->faces.face_count, surface->most_blocks, arena);
	made &= make_parts(&surface->edges, tissue->edges.edge_count, surface->most_blocks, arena);
	made &= make_parts(&surface->vertices, tissue->vertex_count, surface->most_blocks, arena);
	keyed *key = malloc((faces + 1) * sizeof *key);
	if (made && key && surface->mask && surface->order && surface->face_edge &&
	    surface->edge_seen && surface->vertex_seen) {
		order_faces(tissue, key, surface->order);
		memset(surface->face_edge, 0xff, 3 * faces * sizeof(int32_t));
		free(key);
		return CAU_OK;
	}
	free(key);
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the surface that touches");
}

static void end_block(cau_surface *surface)
{
	int32_t b = ++surface->block_count;
	CAU_ASSERT(b <= surface->most_blocks, "%d blocks of %d", b, surface->most_blocks);
	surface->faces.first[b] = surface->faces.count;
	surface->edges.first[b] = surface->edges.count;
	surface->vertices.first[b] = surface->vertices.count;
}

static void take(cau_surface_parts *parts, uint8_t *seen, int32_t item)
{
	if (seen[item])
		return;
	seen[item] = 1;
	parts->item[parts->count++] = item;
}

static void take_face(cau_surface *surface, int32_t face)
{
	const int32_t *vertex = surface->tissue->faces.vertex + 3 * (size_t)face;
	int32_t *edge = surface->face_edge + 3 * (size_t)face;
	surface->faces.item[surface->faces.count++] = face;
	for (int k = 0; k < 3; k++) {
		if (edge[k] < 0)
			edge[k] = cau_edge_table_find(&surface->tissue->edges, vertex[k], vertex[(k + 1) % 3]);
		CAU_ASSERT_INDEX(edge[k], surface->tissue->edges.edge_count);
		take(&surface->edges, surface->edge_seen, edge[k]);
		take(&surface->vertices, surface->vertex_seen, vertex[k]);
	}
	if (surface->faces.count % CAU_SURFACE_BLOCK == 0)
		end_block(surface);
}

void cau_surface_list(cau_surface *surface, const uint32_t *face_mask)
{
	size_t bytes = ((size_t)surface->tissue->faces.face_count + 31) / 32 * sizeof(uint32_t);
	if (surface->listed && memcmp(surface->mask, face_mask, bytes) == 0)
		return;
	memcpy(surface->mask, face_mask, bytes);
	surface->listed = true;
	surface->block_count = 0;
	surface->faces.count = surface->edges.count = surface->vertices.count = 0;
	surface->faces.first[0] = surface->edges.first[0] = surface->vertices.first[0] = 0;
	memset(surface->edge_seen, 0, (size_t)surface->tissue->edges.edge_count);
	memset(surface->vertex_seen, 0, (size_t)surface->tissue->vertex_count);
	for (int32_t i = 0; i < surface->tissue->faces.face_count; i++) {
		int32_t face = surface->order[i];
		if (!(face_mask[face >> 5] >> (face & 31) & 1))
			take_face(surface, face);
	}
	if (surface->faces.count % CAU_SURFACE_BLOCK)
		end_block(surface);
}

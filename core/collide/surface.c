// SPDX-License-Identifier: GPL-3.0-or-later
#include "collide/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"

typedef struct keyed {
	uint32_t key;
	int32_t face;
} keyed;

static int compare(const void *a, const void *b)
{
	const keyed *x = a, *y = b;
	if (x->key != y->key)
		return x->key < y->key ? -1 : 1;
	return (x->face > y->face) - (x->face < y->face);
}

// Orders the faces along a Morton curve through their middles at rest.
static void order_faces(const cau_tissue *tissue, keyed *key, int32_t *order)
{
	double least[3] = {1e300, 1e300, 1e300}, most = 0;
	for (int32_t i = 0; i < 3 * tissue->vertex_count; i++)
		least[i % 3] = fmin(least[i % 3], tissue->rest[i]);
	for (int32_t i = 0; i < 3 * tissue->vertex_count; i++)
		most = fmax(most, tissue->rest[i] - least[i % 3]);
	for (int32_t f = 0; f < tissue->faces.face_count; f++) {
		double unit[3] = {0};
		for (size_t c = 0; c < 3 && most > 0; c++) {
			double middle = 0;
			for (size_t k = 0; k < 3; k++)
				middle += tissue->rest[3 * (size_t)tissue->faces.vertex[3 * (size_t)f + k] + c] / 3;
			unit[c] = fmin(fmax((middle - least[c]) / most, 0), 1);
		}
		key[f] = (keyed){cau_morton(unit), f};
	}
	qsort(key, (size_t)tissue->faces.face_count, sizeof *key, compare);
	for (int32_t f = 0; f < tissue->faces.face_count; f++)
		order[f] = key[f].face;
}

// Whether a face is drawn before anything is cut.
static bool is_outside(const cau_face_table *faces, int32_t face)
{
	const int32_t *owner = faces->owner + 2 * (size_t)face;
	CAU_ASSERT_INDEX(face, faces->face_count);
	return face < faces->triangle_count ||
	       (faces->cover[face] < 0 && (owner[0] < 0) != (owner[1] < 0));
}

static void make_blocks(cau_surface *surface)
{
	int32_t outside = 0, faces = surface->tissue->faces.face_count;
	surface->block_count = 0;
	for (int32_t i = 0; i < faces; i++) {
		outside += is_outside(&surface->tissue->faces, surface->order[i]);
		if (outside == CAU_SURFACE_BLOCK || i + 1 == faces ||
		    i + 1 - surface->own[surface->block_count] == CAU_SURFACE_FACES) {
			surface->own[++surface->block_count] = i + 1;
			outside = 0;
		}
	}
}

static bool make_parts(cau_surface_parts *parts, int32_t most, int32_t blocks, cau_arena *arena)
{
	parts->item = cau_arena_array(arena, (size_t)most, sizeof(int32_t));
	parts->first = cau_arena_array(arena, (size_t)blocks + 1, sizeof(int32_t));
	return parts->item && parts->first;
}

static bool make_places(int32_t *block[2], int32_t count, cau_arena *arena)
{
	for (int i = 0; i < 2; i++) {
		block[i] = cau_arena_array(arena, (size_t)count, sizeof(int32_t));
		if (!block[i])
			return false;
		memset(block[i], 0xff, (size_t)count * sizeof(int32_t));
	}
	return true;
}

static bool make_lists(cau_surface *surface, cau_arena *arena)
{
	const cau_tissue *tissue = surface->tissue;
	int32_t blocks = surface->block_count;
	surface->changed = cau_arena_array(arena, (size_t)tissue->vertex_count, 1);
	return surface->changed &&
	       make_parts(&surface->faces, tissue->faces.face_count, blocks, arena) &&
	       make_parts(&surface->edges, tissue->edges.edge_count, blocks, arena) &&
	       make_parts(&surface->vertices, tissue->vertex_count, blocks, arena) &&
	       make_places(surface->edge_block, tissue->edges.edge_count, arena) &&
	       make_places(surface->vertex_block, tissue->vertex_count, arena);
}

cau_status cau_surface_create(cau_surface *surface, const cau_tissue *tissue, cau_arena *arena,
                              cau_error *error)
{
	size_t faces = (size_t)tissue->faces.face_count;
	surface->tissue = tissue;
	surface->order = cau_arena_array(arena, faces, sizeof(int32_t));
	surface->own = cau_arena_array(arena, faces / CAU_SURFACE_BLOCK + 2, sizeof(int32_t));
	surface->face_edge = cau_arena_array(arena, 3 * faces, sizeof(int32_t));
	surface->mask = cau_arena_array(arena, (faces + 31) / 32, sizeof(uint32_t));
	keyed *key = malloc((faces + 1) * sizeof *key);
	bool made = key && surface->order && surface->own && surface->face_edge && surface->mask;
	if (made) {
		order_faces(tissue, key, surface->order);
		memset(surface->face_edge, 0xff, 3 * faces * sizeof(int32_t));
		make_blocks(surface);
		made = make_lists(surface, arena);
	}
	free(key);
	return made ? CAU_OK
	            : cau_fail(error, CAU_NO_MEMORY, NULL,
	                       "no memory for the surface of tissue contact");
}

static void take(cau_surface_parts *parts, int32_t *block_of, int32_t item, int32_t block)
{
	if (block_of[item] >= 0)
		return;
	block_of[item] = block;
	parts->item[parts->count++] = item;
}

static void take_face(cau_surface *surface, int32_t face, int32_t block)
{
	const int32_t *vertex = surface->tissue->faces.vertex + 3 * (size_t)face;
	int32_t *edge = surface->face_edge + 3 * (size_t)face;
	surface->faces.item[surface->faces.count++] = face;
	for (int k = 0; k < 3; k++) {
		if (edge[k] < 0)
			edge[k] = cau_edge_table_find(&surface->tissue->edges, vertex[k], vertex[(k + 1) % 3]);
		CAU_ASSERT_INDEX(edge[k], surface->tissue->edges.edge_count);
		take(&surface->edges, surface->edge_block[0], edge[k], block);
		take(&surface->vertices, surface->vertex_block[0], vertex[k], block);
	}
}

static void note_changed(cau_surface *surface, const int32_t *corner, int count)
{
	for (int k = 0; k < count; k++)
		surface->changed[corner[k]] = 1;
}

static void list_block(cau_surface *surface, const uint32_t *face_mask, int32_t block)
{
	for (int32_t i = surface->own[block]; i < surface->own[block + 1]; i++) {
		int32_t face = surface->order[i];
		uint32_t bit = face_mask[face >> 5] >> (face & 31) & 1;
		if (bit != (surface->mask[face >> 5] >> (face & 31) & 1))
			note_changed(surface, surface->tissue->faces.vertex + 3 * (size_t)face, 3);
		if (!bit)
			take_face(surface, face, block);
	}
	surface->faces.first[block + 1] = surface->faces.count;
	surface->edges.first[block + 1] = surface->edges.count;
	surface->vertices.first[block + 1] = surface->vertices.count;
}

// Makes the present blocks of edges or vertices the former ones, and sets the present ones to -1.
static void turn_over(int32_t *block[2], int32_t count)
{
	int32_t *before = block[0];
	block[0] = block[1];
	block[1] = before;
	memset(block[0], 0xff, (size_t)count * sizeof(int32_t));
}

// Marks the corners of edges and vertices that are now listed by another block than before, or that
// only began or only ceased to be listed.
static void compare_places(cau_surface *surface)
{
	int32_t *const *edge = surface->edge_block, *const *vertex = surface->vertex_block;
	for (int32_t e = 0; e < surface->tissue->edges.edge_count; e++)
		if (edge[0][e] != edge[1][e])
			note_changed(surface, surface->tissue->edges.vertex + 2 * (size_t)e, 2);
	for (int32_t v = 0; v < surface->tissue->vertex_count; v++)
		if (vertex[0][v] != vertex[1][v])
			note_changed(surface, &v, 1);
}

void cau_surface_list(cau_surface *surface, const uint32_t *face_mask)
{
	const cau_tissue *tissue = surface->tissue;
	size_t bytes = ((size_t)tissue->faces.face_count + 31) / 32 * sizeof(uint32_t);
	if (surface->listed && memcmp(surface->mask, face_mask, bytes) == 0)
		return;
	surface->faces.count = surface->edges.count = surface->vertices.count = 0;
	turn_over(surface->edge_block, tissue->edges.edge_count);
	turn_over(surface->vertex_block, tissue->vertex_count);
	for (int32_t block = 0; block < surface->block_count; block++)
		list_block(surface, face_mask, block);
	compare_places(surface);
	memcpy(surface->mask, face_mask, bytes);
	surface->listed = true;
}

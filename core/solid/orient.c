// SPDX-License-Identifier: GPL-3.0-or-later
#include "solid/mesher.h"

#include <math.h>
#include <stdlib.h>

#include "cautery/assert.h"
#include "mesh/edge_table.h"
#include "mesh/geometry.h"

typedef struct piece {
	double volume6, least[3], most[3];
	int32_t turned, count;
} piece;

typedef struct work {
	cau_mesh *surface;
	cau_edge_table edges;
	int32_t *piece; // (triangle_count): index of the triangle's piece, -1: not reached
	bool *turn;     // (triangle_count)
	int32_t *queue;
	piece *of; // (piece_count)
	int32_t piece_count;
} work;

// Whether the triangle has the edge in the direction from its lower vertex to its higher vertex.
static bool runs_up(const cau_mesh *surface, int32_t triangle, const int32_t *edge)
{
	const int32_t *t = surface->triangle + 3 * (size_t)triangle;
	for (int k = 0; k < 3; k++)
		if (t[k] == edge[0] && t[(k + 1) % 3] == edge[1])
			return true;
	return false;
}

// Returns the other triangle at an edge that two triangles share; -1 at other edges.
static int32_t neighbour(const work *of, int32_t triangle, int32_t edge)
{
	const int32_t *first = of->edges.first[CAU_PRIMITIVE_TRIANGLE];
	const int32_t *sharer = of->edges.sharer[CAU_PRIMITIVE_TRIANGLE] + first[edge];
	if (first[edge + 1] - first[edge] != 2)
		return -1;
	return sharer[0] == triangle ? sharer[1] : sharer[0];
}

// Collects all triangles that are connected to a triangle, as a piece. The start triangle keeps its
// orientation.
static void walk(work *of, int32_t start)
{
	int32_t head = 0, tail = 0, number = of->piece_count++;
	of->queue[tail++] = start;
	of->piece[start] = number;
	while (head < tail) {
		int32_t at = of->queue[head++];
		for (int k = 0; k < 3; k++) {
			int32_t edge = of->edges.triangle_edge[3 * (size_t)at + (size_t)k];
			int32_t other = neighbour(of, at, edge);
			if (other < 0 || of->piece[other] >= 0)
				continue;
			const int32_t *ends = of->edges.vertex + 2 * (size_t)edge;
			bool same = runs_up(of->surface, at, ends) == runs_up(of->surface, other, ends);
			of->turn[other] = of->turn[at] != same;
			of->piece[other] = number;
			of->queue[tail++] = other;
		}
	}
}

static void measure_pieces(work *of)
{
	const double *x = of->surface->position;
	double middle[3] = {0};
	for (size_t i = 0; i < 3 * (size_t)of->surface->vertex_count; i++)
		middle[i % 3] += x[i] / of->surface->vertex_count;
	for (int32_t p = 0; p < of->piece_count; p++)
		of->of[p] = (piece){.least = {INFINITY, INFINITY, INFINITY},
		                    .most = {-INFINITY, -INFINITY, -INFINITY}};
	for (int32_t t = 0; t < of->surface->triangle_count; t++) {
		const int32_t *corner = of->surface->triangle + 3 * (size_t)t;
		piece *at = &of->of[of->piece[t]];
		double normal[3], from[3];
		cau_triangle_normal(x, corner, normal);
		cau_subtract3(x + 3 * (size_t)corner[0], middle, from);
		double volume6 = cau_dot3(from, normal);
		at->volume6 += of->turn[t] ? -volume6 : volume6;
		at->turned += of->turn[t];
		at->count++;
		for (int k = 0; k < 9; k++) {
			double value = x[3 * (size_t)corner[k / 3] + (size_t)(k % 3)];
			at->least[k % 3] = fmin(at->least[k % 3], value);
			at->most[k % 3] = fmax(at->most[k % 3], value);
		}
	}
}

static bool is_inside_another(const work *of, int32_t number)
{
	const piece *own = &of->of[number];
	for (int32_t p = 0; p < of->piece_count; p++) {
		const piece *other = &of->of[p];
		bool inside = p != number;
		for (int c = 0; c < 3 && inside; c++)
			inside = own->least[c] > other->least[c] && own->most[c] < other->most[c];
		if (inside)
			return true;
	}
	return false;
}

// Whether a piece must be turned. Its orientation is that of an arbitrary triangle until now. A
// piece inside another piece gets the orientation of most of its triangles. All other pieces get
// the outward orientation.
static bool turns_over(const work *of, int32_t number)
{
	// Largest number of pieces with which cavities are searched. With more pieces the search is not
	// worth the time.
	enum { PIECES_COMPARED = 2048 };
	const piece *own = &of->of[number];
	if (of->piece_count <= PIECES_COMPARED && is_inside_another(of, number))
		return 2 * own->turned > own->count;
	return own->volume6 < 0;
}

static int32_t turn_all(work *of, const bool *over)
{
	int32_t turned = 0;
	for (int32_t t = 0; t < of->surface->triangle_count; t++) {
		int32_t *corner = of->surface->triangle + 3 * (size_t)t;
		if (of->turn[t] == over[of->piece[t]])
			continue;
		int32_t own = corner[1];
		corner[1] = corner[2];
		corner[2] = own;
		turned++;
	}
	return turned;
}

static cau_status orient(work *of, int32_t *turned, cau_error *error)
{
	size_t count = (size_t)of->surface->triangle_count;
	of->piece = malloc(count * sizeof *of->piece);
	of->turn = calloc(count, sizeof *of->turn);
	of->queue = malloc(count * sizeof *of->queue);
	of->of = malloc(count * sizeof *of->of);
	bool *over = calloc(count, sizeof *over);
	if (!of->piece || !of->turn || !of->queue || !of->of || !over) {
		free(over);
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for turning %zu triangles", count);
	}
	for (size_t t = 0; t < count; t++)
		of->piece[t] = -1;
	for (size_t t = 0; t < count; t++)
		if (of->piece[t] < 0)
			walk(of, (int32_t)t);
	measure_pieces(of);
	for (int32_t p = 0; p < of->piece_count; p++)
		over[p] = turns_over(of, p);
	*turned = turn_all(of, over);
	free(over);
	return CAU_OK;
}

cau_status cau_orient(cau_mesh *surface, int32_t *turned, cau_error *error)
{
	work of = {.surface = surface};
	size_t count = (size_t)surface->triangle_count;
	CAU_ASSERT(count > 0, "a surface of %zu triangles", count);
	cau_primitives triangles = {.vertex_count = surface->vertex_count,
	                            .triangle_count = surface->triangle_count,
	                            .triangle = surface->triangle};
	int32_t *layer = calloc(count, sizeof *layer);
	cau_status status = layer ? cau_edge_table_make(&triangles, layer, &of.edges, error)
	                          : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the edges");
	free(layer);
	if (status)
		return status;
	status = orient(&of, turned, error);
	free(of.piece);
	free(of.turn);
	free(of.queue);
	free(of.of);
	cau_edge_table_finish(&of.edges);
	return status;
}

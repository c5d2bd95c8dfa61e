// SPDX-License-Identifier: GPL-3.0-or-later
// Smooths the mesh. Each vertex moves to where the worst tetrahedron around it is best. A vertex
// inside a label moves freely. A vertex on the interface of two labels slides and is put back on
// the interface. A vertex where more labels meet does not move.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/edge_table.h"
#include "mesh/geometry.h"
#include "solid/mesher.h"

enum { ROUNDS = 8, HALVINGS = 10 };
static const double good = 0.8;    // quality above which a vertex is not moved
static const double better = 1e-3; // least gain in quality of a move
// Distance within which the interface is searched, as a share of the lattice's spacing.
static const double reach_share = 0.25;
static const double steps[] = {1, 0.5, 0.25, 0.1};
static const double nudges[] = {0.2, 0.08, 0.03, -0.05}; // trial moves, as shares of the spacing

// A face between two labels, seen from the tetrahedron of `label`. `other` may be 0, the outside.
typedef struct wall {
	int32_t label, other;
} wall;

typedef struct smoother {
	const cau_domain *domain;
	cau_tets *tets;
	cau_around around; // tetrahedra around each vertex
	int32_t *face;     // (wall_count x 3), facing out of `label`
	wall *wall;
	int32_t wall_count;
	cau_around walls; // walls around each vertex
} smoother;

// ---- walls
static const int face_of[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static void add_wall(smoother *of, int32_t at, int32_t other)
{
	const int32_t *vertex = of->tets->vertex + 4 * (size_t)(at / 4);
	for (int k = 0; k < 3; k++)
		of->face[3 * (size_t)of->wall_count + (size_t)k] = vertex[face_of[at % 4][k]];
	of->wall[of->wall_count++] = (wall){of->tets->label[at / 4], other};
}

static bool find_walls(smoother *of)
{
	int32_t faces = 4 * of->tets->count;
	int32_t *key = malloc(((size_t)faces + 1) * 3 * sizeof *key);
	int32_t *order = malloc(((size_t)faces + 1) * sizeof *order);
	bool done = key && order && of->face && of->wall;
	for (int32_t f = 0; f < faces && done; f++) {
		for (int k = 0; k < 3; k++)
			key[3 * (size_t)f + (size_t)k] =
				of->tets->vertex[4 * (size_t)(f / 4) + (size_t)face_of[f % 4][k]];
		cau_index_order_row(key + 3 * (size_t)f, 3);
	}
	done = done && cau_index_sort(key, 3, faces, of->tets->vertex_count, order);
	for (int32_t i = 0; i < faces && done; i++) {
		const int32_t *own = key + 3 * (size_t)order[i];
		bool shared =
			i + 1 < faces && !memcmp(own, key + 3 * (size_t)order[i + 1], 3 * sizeof *own);
		if (!shared)
			add_wall(of, order[i], 0);
		else if (of->tets->label[order[i] / 4] != of->tets->label[order[i + 1] / 4])
			add_wall(of, order[i], of->tets->label[order[i + 1] / 4]);
		i += shared;
	}
	free(key);
	free(order);
	return done && cau_around_make(&of->walls, of->face, of->wall_count, 3, of->tets->vertex_count);
}

// Finds the two labels at a vertex of an interface. Returns false if more than two meet.
static bool labels_at(const smoother *of, int32_t vertex, wall *at)
{
	*at = of->wall[of->walls.item[of->walls.first[vertex]]];
	for (int32_t i = of->walls.first[vertex]; i < of->walls.first[vertex + 1]; i++) {
		wall own = of->wall[of->walls.item[i]];
		if (!(own.label == at->label && own.other == at->other) &&
		    !(own.label == at->other && own.other == at->label))
			return false;
	}
	return true;
}

// Computes the interface's normal at a vertex, from at.label to at.other. Returns false if there is
// no normal.
static bool normal_at(const smoother *of, int32_t vertex, wall at, double normal[3])
{
	memset(normal, 0, 3 * sizeof *normal);
	for (int32_t i = of->walls.first[vertex]; i < of->walls.first[vertex + 1]; i++) {
		double own[3], sign = of->wall[of->walls.item[i]].label == at.label ? 1 : -1;
		cau_triangle_normal(of->tets->position, of->face + 3 * (size_t)of->walls.item[i], own);
		for (int c = 0; c < 3; c++)
			normal[c] += sign * own[c];
	}
	double size = sqrt(cau_dot3(normal, normal));
	for (int c = 0; c < 3 && size > 0; c++)
		normal[c] /= size;
	return size > 0;
}

// Puts x back on the interface along the normal. Returns false if the interface is not within
// reach.
static bool put_back(const smoother *of, wall at, const double normal[3], double x[3])
{
	double reach = reach_share * of->tets->spacing, in = -reach, out = reach, place[3];
	for (int k = 0; k < HALVINGS + 2; k++) {
		double middle = k == 0 ? in : k == 1 ? out : (in + out) / 2;
		for (int c = 0; c < 3; c++)
			place[c] = x[c] + middle * normal[c];
		int32_t label = of->domain->label_at(of->domain, place, NULL);
		if ((k == 0 && label != at.label) || (k == 1 && label != at.other))
			return false;
		in = label == at.label ? middle : in;
		out = label == at.label ? out : middle;
	}
	for (int c = 0; c < 3; c++)
		x[c] += (in + out) / 2 * normal[c];
	return true;
}

// ---- moves
// Computes the vector from a vertex to the mean of its neighbours. If wall_only, only neighbours on
// the interface count.
static void direction_to_middle(const smoother *of, int32_t vertex, bool wall_only, double to[3])
{
	const cau_around *around = wall_only ? &of->walls : &of->around;
	const int32_t *element = wall_only ? of->face : of->tets->vertex;
	size_t corners = wall_only ? 3 : 4, count = 0;
	memset(to, 0, 3 * sizeof *to);
	for (int32_t i = around->first[vertex]; i < around->first[vertex + 1]; i++)
		for (size_t k = 0; k < corners; k++) {
			int32_t other = element[corners * (size_t)around->item[i] + k];
			if (other == vertex)
				continue;
			for (int c = 0; c < 3; c++)
				to[c] += of->tets->position[3 * (size_t)other + (size_t)c];
			count++;
		}
	CAU_ASSERT(count > 0, "vertex %d has no neighbour", vertex);
	for (int c = 0; c < 3; c++)
		to[c] = to[c] / (double)count - of->tets->position[3 * (size_t)vertex + (size_t)c];
}

// Computes a vector away from the face opposite the vertex, in the worst tetrahedron around the
// vertex.
static void direction_from_worst(const smoother *of, int32_t vertex, double to[3])
{
	double least = 2;
	for (int32_t i = of->around.first[vertex]; i < of->around.first[vertex + 1]; i++) {
		const int32_t *own = of->tets->vertex + 4 * (size_t)of->around.item[i];
		double quality = cau_tet_quality(of->tets->position, own);
		if (quality >= least)
			continue;
		least = quality;
		int k = 0;
		while (own[k] != vertex)
			k++;
		int32_t face[3] = {own[face_of[k][0]], own[face_of[k][1]], own[face_of[k][2]]};
		cau_triangle_normal(of->tets->position, face, to);
	}
	double size = sqrt(cau_dot3(to, to));
	for (int c = 0; c < 3; c++) // the face's normal points away from the vertex
		to[c] *= size > 0 ? -of->tets->spacing / size : 0;
}

typedef struct place {
	bool on_wall;
	wall labels;
	double normal[3];
} place;

// Moves the vertex by a share of `to` if the least quality around it becomes better than `was`.
// Returns the least quality afterwards.
static double try_move(const smoother *of, int32_t vertex, const place *at, const double to[3],
                       double share, double was)
{
	double *x = of->tets->position + 3 * (size_t)vertex, before[3];
	memcpy(before, x, sizeof before);
	double along = at->on_wall ? cau_dot3(to, at->normal) : 0;
	for (int c = 0; c < 3; c++)
		x[c] += share * (to[c] - along * (at->on_wall ? at->normal[c] : 0));
	double is = cau_least_around(of->tets, &of->around, vertex, was);
	if (is > was + better && at->on_wall)
		is = put_back(of, at->labels, at->normal, x)
		         ? cau_least_around(of->tets, &of->around, vertex, was)
		         : -1;
	if (is > was + better)
		return is;
	memcpy(x, before, sizeof before);
	return was;
}

static void improve(const smoother *of, int32_t vertex)
{
	place at = {.on_wall = of->walls.first[vertex] < of->walls.first[vertex + 1]};
	double was = cau_least_around(of->tets, &of->around, vertex, -1), to[3];
	if (was >= good || (at.on_wall && (!labels_at(of, vertex, &at.labels) ||
	                                   !normal_at(of, vertex, at.labels, at.normal))))
		return;
	direction_to_middle(of, vertex, at.on_wall, to);
	double is = was;
	for (size_t k = 0; k < sizeof steps / sizeof *steps && is == was; k++)
		is = try_move(of, vertex, &at, to, steps[k], was);
	direction_from_worst(of, vertex, to);
	was = is;
	for (size_t k = 0; k < sizeof nudges / sizeof *nudges && is == was; k++)
		is = try_move(of, vertex, &at, to, nudges[k], was);
}

cau_status cau_smooth(const cau_domain *domain, cau_tets *tets, cau_error *error)
{
	smoother of = {.domain = domain, .tets = tets};
	size_t faces = 4 * (size_t)tets->count + 1;
	of.face = malloc(faces * 3 * sizeof *of.face);
	of.wall = malloc(faces * sizeof *of.wall);
	bool done = cau_around_make(&of.around, tets->vertex, tets->count, 4, tets->vertex_count) &&
	            find_walls(&of);
	for (int round = 0; round < ROUNDS && done; round++)
		for (int32_t v = 0; v < tets->vertex_count; v++)
			improve(&of, v);
	cau_around_finish(&of.around);
	cau_around_finish(&of.walls);
	free(of.face);
	free(of.wall);
	return done ? CAU_OK : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for smoothing");
}

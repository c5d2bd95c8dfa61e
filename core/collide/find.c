// SPDX-License-Identifier: GPL-3.0-or-later
// Broad phase: which pairs may come nearer than their thickness while each vertex stays within its
// reach. Boxes of parts, grown by what their corners may move, are held against boxes of blocks and
// then against each other. What blocks find goes to slices of their own and is gathered in order.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "collide/collide.h"

static const double least_reach = 0.5;   // of the thickness: where nothing is foreseen
static const double foresight = 1.25;    // of the step that is foreseen
static const double most_reach_m = 1e-3; // further on, pairs are looked for again
// A pair keeps at most so much of the distance that it has at rest: neighbours, between which the
// surface itself may be drawn together, less than others.
static const double near_share = 0.1, far_share = 0.5;
static const double least_thickness = 0.002; // of the surface's: below, a pair is left out
enum { TRIES = 12 };

// ---- boxes
static cau_collide_box box_round(const cau_collide *collide, const int32_t *vertex, int count,
                                 const double *x)
{
	cau_collide_box box = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
	for (int k = 0; k < count; k++) {
		size_t v = (size_t)vertex[k];
		for (size_t c = 0; c < 3; c++) {
			box.least[c] = fmin(box.least[c], x[3 * v + c] - collide->reach_m[v]);
			box.most[c] = fmax(box.most[c], x[3 * v + c] + collide->reach_m[v]);
		}
	}
	return box;
}

static cau_collide_box box_of_all(const cau_collide_box *box, int32_t first, int32_t last)
{
	cau_collide_box all = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
	for (int32_t i = first; i < last; i++)
		for (int c = 0; c < 3; c++) {
			all.least[c] = fmin(all.least[c], box[i].least[c]);
			all.most[c] = fmax(all.most[c], box[i].most[c]);
		}
	return all;
}

static bool meets(const cau_collide_box *a, const cau_collide_box *b, double by_m)
{
	return a->least[0] - by_m <= b->most[0] && b->least[0] - by_m <= a->most[0] &&
	       a->least[1] - by_m <= b->most[1] && b->least[1] - by_m <= a->most[1] &&
	       a->least[2] - by_m <= b->most[2] && b->least[2] - by_m <= a->most[2];
}

// A loop over blocks.
typedef struct search {
	cau_collide *collide;
	const double *x;
} search;

static const int32_t *face_corners(const cau_collide *collide, int32_t place)
{
	return collide->tissue->faces.vertex + 3 * (size_t)collide->surface.faces.item[place];
}

static const int32_t *edge_corners(const cau_collide *collide, int32_t place)
{
	return collide->tissue->edges.vertex + 2 * (size_t)collide->surface.edges.item[place];
}

static void box_part(void *context, int32_t block)
{
	const search *work = context;
	cau_collide *collide = work->collide;
	const cau_surface *surface = &collide->surface;
	CAU_ASSERT_INDEX(block, surface->block_count);
	const int32_t *faces = surface->faces.first + block, *edges = surface->edges.first + block,
				  *vertices = surface->vertices.first + block;
	for (int32_t i = faces[0]; i < faces[1]; i++)
		collide->face_box[i] = box_round(collide, face_corners(collide, i), 3, work->x);
	for (int32_t i = edges[0]; i < edges[1]; i++)
		collide->edge_box[i] = box_round(collide, edge_corners(collide, i), 2, work->x);
	for (int32_t i = vertices[0]; i < vertices[1]; i++)
		collide->vertex_box[i] = box_round(collide, surface->vertices.item + i, 1, work->x);
	collide->block_box[0][block] = box_of_all(collide->face_box, faces[0], faces[1]);
	collide->block_box[1][block] = box_of_all(collide->edge_box, edges[0], edges[1]);
	collide->block_box[2][block] = box_of_all(collide->vertex_box, vertices[0], vertices[1]);
}

// ---- pairs
static bool is_exempt(const cau_collide *collide, const int32_t *vertex, int count)
{
	for (int k = 0; k < count; k++)
		if (collide->exempt[vertex[k]])
			return true;
	return false;
}

// Whether corners are nearer than the thickness and all that they may move: first along the line
// between the parts' middles, which tells most.
static bool may_touch(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4],
                      const double *x)
{
	cau_vec3 corner[4], middle[2] = {{0, 0, 0}, {0, 0, 0}};
	double reach[2] = {0, 0};
	int firsts = cau_gap_first(kind);
	for (int i = 0; i < 4; i++) {
		int part = i >= firsts;
		corner[i] = cau_vec3_of(x + 3 * (size_t)vertex[i]);
		middle[part] = cau_add_scaled(middle[part], 1.0 / (part ? 4 - firsts : firsts), corner[i]);
		reach[part] = fmax(reach[part], collide->reach_m[vertex[i]]);
	}
	double most = collide->thickness_m + reach[0] + reach[1];
	cau_vec3 way = cau_sub(middle[0], middle[1]);
	if (cau_gap_along(kind, corner, way) > most * cau_length(way))
		return false;
	return cau_gap_between(kind, corner).distance <= most;
}

static void list(cau_collide *collide, int32_t block, cau_gap_kind kind, int32_t first,
                 int32_t second)
{
	cau_collide_slice *slice = &collide->slice[block];
	if (slice->count[kind] == CAU_COLLIDE_SLICE) {
		slice->full = true;
		return;
	}
	collide->list[kind][(size_t)block * CAU_COLLIDE_SLICE + (size_t)slice->count[kind]++] =
		(cau_collide_found){first, second};
}

// Parts of another block that meet this one's box: most of a neighbour do not.
typedef struct near_parts {
	int32_t count, place[3 * CAU_SURFACE_BLOCK];
} near_parts;

static void list_near(const cau_collide *collide, const cau_collide_box *within,
                      const cau_surface_parts *parts, const cau_collide_box *box, int32_t block,
                      near_parts *near)
{
	near->count = 0;
	for (int32_t i = parts->first[block]; i < parts->first[block + 1]; i++)
		if (meets(within, &box[i], collide->thickness_m))
			near->place[near->count++] = i;
}

static void look_at_vertices(const search *work, int32_t block, int32_t other)
{
	cau_collide *collide = work->collide;
	const cau_surface *surface = &collide->surface;
	near_parts vertices, faces;
	list_near(collide, &collide->block_box[0][other], &surface->vertices, collide->vertex_box,
	          block, &vertices);
	list_near(collide, &collide->block_box[2][block], &surface->faces, collide->face_box, other,
	          &faces);
	for (int32_t i = 0; i < vertices.count; i++) {
		int32_t v = surface->vertices.item[vertices.place[i]];
		const cau_collide_box *box = &collide->vertex_box[vertices.place[i]];
		for (int32_t j = 0; j < faces.count && !collide->exempt[v]; j++) {
			int32_t f = faces.place[j];
			const int32_t *c = face_corners(collide, f);
			if (!meets(box, &collide->face_box[f], collide->thickness_m) || c[0] == v ||
			    c[1] == v || c[2] == v || is_exempt(collide, c, 3))
				continue;
			if (may_touch(collide, CAU_GAP_VERTEX_FACE, (int32_t[]){v, c[0], c[1], c[2]}, work->x))
				list(collide, block, CAU_GAP_VERTEX_FACE, vertices.place[i], f);
		}
	}
}

static void look_at_edges(const search *work, int32_t block, int32_t other)
{
	cau_collide *collide = work->collide;
	const cau_surface *surface = &collide->surface;
	near_parts own, others;
	list_near(collide, &collide->block_box[1][other], &surface->edges, collide->edge_box, block,
	          &own);
	list_near(collide, &collide->block_box[1][block], &surface->edges, collide->edge_box, other,
	          &others);
	for (int32_t i = 0; i < own.count; i++) {
		const int32_t *a = edge_corners(collide, own.place[i]);
		const cau_collide_box *box = &collide->edge_box[own.place[i]];
		if (is_exempt(collide, a, 2))
			continue;
		for (int32_t j = block == other ? i + 1 : 0; j < others.count; j++) {
			int32_t e = others.place[j];
			const int32_t *b = edge_corners(collide, e);
			if (!meets(box, &collide->edge_box[e], collide->thickness_m) || a[0] == b[0] ||
			    a[0] == b[1] || a[1] == b[0] || a[1] == b[1] || is_exempt(collide, b, 2))
				continue;
			if (may_touch(collide, CAU_GAP_EDGE_EDGE, (int32_t[]){a[0], a[1], b[0], b[1]}, work->x))
				list(collide, block, CAU_GAP_EDGE_EDGE, own.place[i], e);
		}
	}
}

static void search_part(void *context, int32_t block)
{
	const search *work = context;
	cau_collide *collide = work->collide;
	const cau_surface *surface = &collide->surface;
	CAU_ASSERT_INDEX(block, surface->block_count);
	collide->slice[block] = (cau_collide_slice){0};
	for (int32_t other = 0; other < surface->block_count; other++) {
		if (meets(&collide->block_box[2][block], &collide->block_box[0][other],
		          collide->thickness_m))
			look_at_vertices(work, block, other);
		if (other >= block && meets(&collide->block_box[1][block], &collide->block_box[1][other],
		                            collide->thickness_m))
			look_at_edges(work, block, other);
	}
}

// ---- what a pair is

static bool are_joined(const cau_collide *collide, const cau_collide_pair *pair)
{
	int firsts = cau_gap_first(pair->kind);
	for (int i = 0; i < firsts; i++)
		for (int j = firsts; j < 4; j++)
			if (cau_edge_table_find(&collide->tissue->edges, pair->vertex[i], pair->vertex[j]) >= 0)
				return true;
	return false;
}

// False: at rest the parts are in one place.
static bool describe(const cau_collide *collide, cau_collide_pair *pair, const double *x)
{
	cau_vec3 corner[4];
	cau_collide_corners(pair, collide->tissue->rest, corner);
	double apart = cau_gap_between(pair->kind, corner).distance, whole = collide->thickness_m;
	double share = are_joined(collide, pair) ? near_share : far_share;
	pair->thickness_m = fmin(whole, share * apart);
	pair->stiffness = INFINITY;
	for (int i = 0; i < 4; i++)
		pair->stiffness = fmin(pair->stiffness, collide->stiffness[pair->vertex[i]]);
	cau_collide_corners(pair, x, corner);
	pair->plane = cau_gap_between(pair->kind, corner).normal;
	pair->slope = 0;
	return pair->thickness_m >= least_thickness * whole;
}

static bool gather(cau_collide *collide, const double *x)
{
	const cau_surface *surface = &collide->surface;
	collide->pair_count = 0;
	for (int32_t b = 0; b < surface->block_count; b++)
		for (int kind = 0; kind < 2; kind++)
			for (int32_t k = 0; k < collide->slice[b].count[kind]; k++) {
				cau_collide_found found =
					collide->list[kind][(size_t)b * CAU_COLLIDE_SLICE + (size_t)k];
				if (collide->pair_count == collide->most_pairs)
					return false;
				cau_collide_pair *pair = &collide->pair[collide->pair_count];
				pair->kind = (cau_gap_kind)kind;
				if (kind == CAU_GAP_VERTEX_FACE) {
					pair->vertex[0] = surface->vertices.item[found.first];
					memcpy(pair->vertex + 1, face_corners(collide, found.second),
					       3 * sizeof(int32_t));
				} else {
					memcpy(pair->vertex, edge_corners(collide, found.first), 2 * sizeof(int32_t));
					memcpy(pair->vertex + 2, edge_corners(collide, found.second),
					       2 * sizeof(int32_t));
				}
				collide->pair_count += describe(collide, pair, x);
			}
	return true;
}

// ---- where they are valid

static bool search_within(cau_collide *collide, cau_pool *pool, const double *x)
{
	search work = {collide, x};
	cau_pool_run(pool, collide->surface.block_count, box_part, &work);
	cau_pool_run(pool, collide->surface.block_count, search_part, &work);
	for (int32_t b = 0; b < collide->surface.block_count; b++)
		if (collide->slice[b].full)
			return false;
	return gather(collide, x);
}

static void foresee(cau_collide *collide, const double *x, const double *step)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	for (int32_t k = 0; k < vertices->count; k++) {
		size_t v = (size_t)vertices->item[k];
		double way = step ? cau_length(cau_vec3_of(step + 3 * v)) : 0;
		double most = fmax(most_reach_m, collide->thickness_m);
		collide->reach_m[v] = fmin(fmax(foresight * way, least_reach * collide->thickness_m), most);
		memcpy(collide->anchor + 3 * v, x + 3 * v, 3 * sizeof *x);
	}
}

void cau_collide_find(cau_collide *collide, cau_pool *pool, const double *x, const double *step)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	CAU_ASSERT(collide->surface.listed, "%d faces drawn", collide->surface.faces.count);
	foresee(collide, x, step);
	collide->search_count++;
	collide->found = true;
	for (int tries = 0; !search_within(collide, pool, x); tries++) {
		collide->cut_short = true;
		for (int32_t k = 0; k < vertices->count; k++)
			collide->reach_m[vertices->item[k]] *= tries < TRIES ? 0.5 : 0;
		if (tries > TRIES) // not even what touches has room
			return;
	}
}

bool cau_collide_covers(const cau_collide *collide, const double *x)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	if (!collide->found)
		return false;
	for (int32_t k = 0; k < vertices->count; k++) {
		size_t v = (size_t)vertices->item[k];
		cau_vec3 way = cau_sub(cau_vec3_of(x + 3 * v), cau_vec3_of(collide->anchor + 3 * v));
		if (!(cau_dot(way, way) <= collide->reach_m[v] * collide->reach_m[v]))
			return false;
	}
	return true;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Broad phase: which pairs may come nearer than their thickness while each vertex stays within its
// reach of where it was anchored. Boxes of parts, grown by what their corners may move, are held
// against boxes of blocks and then against each other.
//
// Pairs live on from tick to tick. Where a vertex has left its reach, those that have used up some
// of theirs are anchored anew, and the blocks they belong to, as those that list other parts since
// a cut, are looked at again; all else is kept. What a block finds is ordered by parts alone. So
// which pairs touch, and in what order, does not depend on when they were found.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "collide/collide.h"

static const double least_room = 0.4;   // of the thickness: where no step is asked for
static const double room_of_step = 1.5; // what others push is moved farther than it wanted
static const double least_reach = 0.3;  // of the thickness, beyond that: for the ticks to come
static const double foresight = 2;      // of the step, likewise, where tissue moves on
static const double used_up = 0.2;      // of that: then anchored anew with those beyond it
// A pair keeps at most so much of the distance that it has at rest: neighbours, between which the
// surface itself may be drawn together, less than others.
static const double near_share = 0.1, far_share = 0.5;
static const double least_thickness = 0.002; // of the surface's: below, a pair is left out
enum { TRIES = 12 };

// ---- boxes
static cau_collide_box box_round(const cau_collide *collide, const int32_t *vertex, int count)
{
	const double *x = collide->anchor;
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

static cau_collide_box box_of_all(const cau_collide_box *box, const cau_surface_parts *parts,
                                  int32_t block)
{
	cau_collide_box all = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
	for (int32_t i = parts->first[block]; i < parts->first[block + 1]; i++)
		for (int c = 0; c < 3; c++) {
			all.least[c] = fmin(all.least[c], box[parts->item[i]].least[c]);
			all.most[c] = fmax(all.most[c], box[parts->item[i]].most[c]);
		}
	return all;
}

static bool meets(const cau_collide_box *a, const cau_collide_box *b, double by_m)
{
	return a->least[0] - by_m <= b->most[0] && b->least[0] - by_m <= a->most[0] &&
	       a->least[1] - by_m <= b->most[1] && b->least[1] - by_m <= a->most[1] &&
	       a->least[2] - by_m <= b->most[2] && b->least[2] - by_m <= a->most[2];
}

static const int32_t *face_corners(const cau_collide *collide, int32_t face)
{
	return collide->tissue->faces.vertex + 3 * (size_t)face;
}

static const int32_t *edge_corners(const cau_collide *collide, int32_t edge)
{
	return collide->tissue->edges.vertex + 2 * (size_t)edge;
}

static void box_part(void *context, int32_t index)
{
	cau_collide *collide = context;
	const cau_surface *surface = &collide->surface;
	int32_t block = collide->changed[index];
	const int32_t *faces = surface->faces.first + block, *edges = surface->edges.first + block,
				  *vertices = surface->vertices.first + block;
	CAU_ASSERT_INDEX(block, surface->block_count);
	for (int32_t i = faces[0]; i < faces[1]; i++) {
		int32_t f = surface->faces.item[i];
		collide->face_box[f] = box_round(collide, face_corners(collide, f), 3);
	}
	for (int32_t i = edges[0]; i < edges[1]; i++) {
		int32_t e = surface->edges.item[i];
		collide->edge_box[e] = box_round(collide, edge_corners(collide, e), 2);
	}
	for (int32_t i = vertices[0]; i < vertices[1]; i++) {
		int32_t v = surface->vertices.item[i];
		collide->vertex_box[v] = box_round(collide, &v, 1);
	}
	collide->block_box[0][block] = box_of_all(collide->face_box, &surface->faces, block);
	collide->block_box[1][block] = box_of_all(collide->edge_box, &surface->edges, block);
	collide->block_box[2][block] = box_of_all(collide->vertex_box, &surface->vertices, block);
}

// ---- what a pair is

static bool is_shared(const cau_collide *collide, int kind, int32_t edge)
{
	const cau_edge_table *edges = &collide->tissue->edges;
	CAU_ASSERT_INDEX(edge, edges->edge_count);
	for (int32_t k = edges->first[kind][edge]; k < edges->first[kind][edge + 1]; k++)
		if (!collide->alive[kind] || collide->alive[kind][edges->sharer[kind][k]])
			return true;
	return false;
}

// How much of its distance at rest a pair keeps: by what joins its parts and is alive.
static double share_of(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4])
{
	int firsts = cau_gap_first(kind);
	for (int i = 0; i < firsts; i++)
		for (int j = firsts; j < 4; j++) {
			int32_t edge = cau_edge_table_find(&collide->tissue->edges, vertex[i], vertex[j]);
			for (int k = 0; k < CAU_PRIMITIVE_KINDS && edge >= 0; k++)
				if (is_shared(collide, k, edge))
					return near_share;
		}
	return far_share;
}

static void describe(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4],
                     cau_collide_found *found)
{
	cau_vec3 corner[4];
	for (int i = 0; i < 4; i++)
		corner[i] = cau_vec3_of(collide->tissue->rest + 3 * (size_t)vertex[i]);
	double apart = cau_gap_between(kind, corner).distance;
	found->thickness_m = fmin(collide->thickness_m, share_of(collide, kind, vertex) * apart);
	found->stiffness = INFINITY;
	for (int i = 0; i < 4; i++)
		found->stiffness = fmin(found->stiffness, collide->stiffness[vertex[i]]);
}

// ---- pairs
// Whether corners may come nearer than their thickness with all that they may move: first along the
// line between the parts' middles, which tells most.
static bool may_touch(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4],
                      cau_collide_found *found)
{
	cau_vec3 corner[4], middle[2] = {{0, 0, 0}, {0, 0, 0}};
	double reach[2] = {0, 0};
	int firsts = cau_gap_first(kind);
	for (int i = 0; i < 4; i++) {
		int part = i >= firsts;
		corner[i] = cau_vec3_of(collide->anchor + 3 * (size_t)vertex[i]);
		middle[part] = cau_add_scaled(middle[part], 1.0 / (part ? 4 - firsts : firsts), corner[i]);
		reach[part] = fmax(reach[part], collide->reach_m[vertex[i]]);
	}
	double may_move = reach[0] + reach[1], most = collide->thickness_m + may_move;
	cau_vec3 way = cau_sub(middle[0], middle[1]);
	if (cau_gap_along(kind, corner, way) > most * cau_length(way))
		return false;
	double apart = cau_gap_between(kind, corner).distance;
	if (apart > most)
		return false;
	describe(collide, kind, vertex, found);
	return found->thickness_m >= least_thickness * collide->thickness_m &&
	       apart <= found->thickness_m + may_move;
}

static void list(cau_collide *collide, int32_t block, cau_gap_kind kind, cau_collide_found found)
{
	cau_collide_slice *slice = &collide->slice[block];
	if (slice->count[kind] == CAU_COLLIDE_SLICE) {
		slice->full = true;
		return;
	}
	collide->list[kind][(size_t)block * CAU_COLLIDE_SLICE + (size_t)slice->count[kind]++] = found;
}

// Parts of a block that meet another one's box: most of a neighbour do not.
typedef struct near_parts {
	int32_t count, item[3 * CAU_SURFACE_FACES];
} near_parts;

static void list_near(const cau_collide *collide, const cau_collide_box *within,
                      const cau_surface_parts *parts, const cau_collide_box *box, int32_t block,
                      near_parts *near)
{
	near->count = 0;
	for (int32_t i = parts->first[block]; i < parts->first[block + 1]; i++)
		if (meets(within, &box[parts->item[i]], collide->thickness_m))
			near->item[near->count++] = parts->item[i];
}

static void look_at_vertices(cau_collide *collide, int32_t block, int32_t other)
{
	const cau_surface *surface = &collide->surface;
	near_parts vertices, faces;
	list_near(collide, &collide->block_box[0][other], &surface->vertices, collide->vertex_box,
	          block, &vertices);
	list_near(collide, &collide->block_box[2][block], &surface->faces, collide->face_box, other,
	          &faces);
	for (int32_t i = 0; i < vertices.count; i++) {
		int32_t v = vertices.item[i];
		const cau_collide_box *box = &collide->vertex_box[v];
		for (int32_t j = 0; j < faces.count; j++) {
			cau_collide_found found = {v, faces.item[j], other, 0, 0};
			const int32_t *c = face_corners(collide, found.second);
			if (meets(box, &collide->face_box[found.second], collide->thickness_m) && c[0] != v &&
			    c[1] != v && c[2] != v &&
			    may_touch(collide, CAU_GAP_VERTEX_FACE, (int32_t[]){v, c[0], c[1], c[2]}, &found))
				list(collide, block, CAU_GAP_VERTEX_FACE, found);
		}
	}
}

static void look_at_edges(cau_collide *collide, int32_t block, int32_t other)
{
	const cau_surface *surface = &collide->surface;
	near_parts own, others;
	list_near(collide, &collide->block_box[1][other], &surface->edges, collide->edge_box, block,
	          &own);
	list_near(collide, &collide->block_box[1][block], &surface->edges, collide->edge_box, other,
	          &others);
	for (int32_t i = 0; i < own.count; i++) {
		const int32_t *a = edge_corners(collide, own.item[i]);
		const cau_collide_box *box = &collide->edge_box[own.item[i]];
		for (int32_t j = block == other ? i + 1 : 0; j < others.count; j++) {
			cau_collide_found found = {own.item[i], others.item[j], other, 0, 0};
			const int32_t *b = edge_corners(collide, found.second);
			if (meets(box, &collide->edge_box[found.second], collide->thickness_m) &&
			    a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1] &&
			    may_touch(collide, CAU_GAP_EDGE_EDGE, (int32_t[]){a[0], a[1], b[0], b[1]}, &found))
				list(collide, block, CAU_GAP_EDGE_EDGE, found);
		}
	}
}

static void look_at(cau_collide *collide, int32_t block, int32_t other)
{
	if (meets(&collide->block_box[2][block], &collide->block_box[0][other], collide->thickness_m))
		look_at_vertices(collide, block, other);
	if (other >= block &&
	    meets(&collide->block_box[1][block], &collide->block_box[1][other], collide->thickness_m))
		look_at_edges(collide, block, other);
}

// ---- what a block keeps

// Takes out what it had with blocks that have changed.
static void keep(cau_collide *collide, int32_t block)
{
	cau_collide_slice *slice = &collide->slice[block];
	for (int kind = 0; kind < 2; kind++) {
		cau_collide_found *found = collide->list[kind] + (size_t)block * CAU_COLLIDE_SLICE;
		int32_t kept = 0;
		for (int32_t k = 0; k < slice->count[kind]; k++)
			if (!collide->surface.changed[found[k].block])
				found[kept++] = found[k];
		slice->count[kind] = kept;
	}
}

// By the other block; what is of one block stays in its order.
static void sort(cau_collide_found *found, int32_t count)
{
	for (int32_t i = 1; i < count; i++) {
		cau_collide_found moved = found[i];
		int32_t at = i;
		for (; at > 0 && found[at - 1].block > moved.block; at--)
			found[at] = found[at - 1];
		found[at] = moved;
	}
}

static void search_part(void *context, int32_t block)
{
	cau_collide *collide = context;
	cau_collide_slice *slice = &collide->slice[block];
	CAU_ASSERT_INDEX(block, collide->surface.block_count);
	if (collide->surface.changed[block]) {
		*slice = (cau_collide_slice){0};
		for (int32_t other = 0; other < collide->surface.block_count; other++)
			look_at(collide, block, other);
		return;
	}
	if (slice->count[0] || slice->count[1])
		keep(collide, block);
	for (int32_t k = 0; k < collide->changed_count; k++)
		look_at(collide, block, collide->changed[k]);
	for (int kind = 0; kind < 2; kind++)
		sort(collide->list[kind] + (size_t)block * CAU_COLLIDE_SLICE, slice->count[kind]);
}

static bool gather(cau_collide *collide)
{
	collide->pair_count = 0;
	for (int32_t b = 0; b < collide->surface.block_count; b++)
		for (int kind = 0; kind < 2; kind++)
			for (int32_t k = 0; k < collide->slice[b].count[kind]; k++) {
				const cau_collide_found *found =
					&collide->list[kind][(size_t)b * CAU_COLLIDE_SLICE + (size_t)k];
				if (collide->pair_count == collide->most_pairs)
					return false;
				collide->apart_m[collide->pair_count] = 0; // not known
				cau_collide_pair *pair = &collide->pair[collide->pair_count++];
				pair->kind = (cau_gap_kind)kind;
				pair->thickness_m = found->thickness_m;
				pair->stiffness = found->stiffness;
				pair->plane = (cau_vec3){0, 0, 0};
				pair->slope = 0;
				pair->vertex[0] = found->first;
				if (kind == CAU_GAP_VERTEX_FACE) {
					memcpy(pair->vertex + 1, face_corners(collide, found->second),
					       3 * sizeof(int32_t));
				} else {
					memcpy(pair->vertex, edge_corners(collide, found->first), 2 * sizeof(int32_t));
					memcpy(pair->vertex + 2, edge_corners(collide, found->second),
					       2 * sizeof(int32_t));
				}
			}
	return true;
}

// Looks at the blocks that have changed. Returns whether there was room for all that is there.
static bool search(cau_collide *collide, cau_pool *pool)
{
	const cau_surface *surface = &collide->surface;
	collide->changed_count = 0;
	for (int32_t b = 0; b < surface->block_count; b++)
		if (surface->changed[b])
			collide->changed[collide->changed_count++] = b;
	if (!collide->changed_count)
		return true;
	cau_pool_run(pool, collide->changed_count, box_part, collide);
	cau_pool_run(pool, surface->block_count, search_part, collide);
	bool room = true;
	for (int32_t b = 0; b < surface->block_count; b++)
		room &= !collide->slice[b].full;
	memset(surface->changed, 0, (size_t)surface->block_count);
	return gather(collide) && room;
}

// ---- where they are valid

double cau_collide_most_room(const cau_collide *collide, double step_m)
{
	double room = room_of_step * step_m, least = least_room * collide->thickness_m;
	return room > least ? room : least;
}

double cau_collide_room(const cau_collide *collide, int32_t vertex)
{
	cau_vec3 step = cau_vec3_of(collide->step + 3 * (size_t)vertex);
	double least = least_room * collide->thickness_m, way2 = cau_dot(step, step);
	if (room_of_step * room_of_step * way2 <= least * least)
		return least;
	return cau_collide_most_room(collide, sqrt(way2));
}

// Whether x is within a share of a vertex's reach, less the room for, `stepping`, a step from x.
static bool is_enough(const cau_collide *collide, const double *x, bool stepping, int32_t v,
                      double share)
{
	cau_vec3 from = cau_vec3_of(collide->anchor + 3 * (size_t)v);
	cau_vec3 away = cau_sub(cau_vec3_of(x + 3 * (size_t)v), from);
	double left = share * (collide->reach_m[v] - (stepping ? cau_collide_room(collide, v) : 0));
	return left >= 0 && cau_dot(away, away) <= left * left;
}

static void anchor(cau_collide *collide, const double *x, int32_t v, double reach_m)
{
	const double rounding = 1 + 1e-6; // a place that uses up all of it is within
	memcpy(collide->anchor + 3 * (size_t)v, x + 3 * (size_t)v, 3 * sizeof *x);
	collide->reach_m[v] = rounding * reach_m;
	collide->moved[v] = 1;
}

// Blocks of faces with a corner that was anchored anew change.
static void note_moved(cau_collide *collide)
{
	const cau_surface_parts *faces = &collide->surface.faces;
	for (int32_t b = 0; b < collide->surface.block_count; b++)
		for (int32_t i = faces->first[b]; i < faces->first[b + 1] && !collide->surface.changed[b];
		     i++) {
			const int32_t *c = face_corners(collide, faces->item[i]);
			collide->surface.changed[b] =
				collide->moved[c[0]] | collide->moved[c[1]] | collide->moved[c[2]];
		}
	memset(collide->moved, 0, (size_t)collide->tissue->vertex_count);
}

static void anchor_used_up(cau_collide *collide, const double *x, bool stepping)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	double least = least_reach * collide->thickness_m;
	double most = fmax(cau_collide_most_step_m, collide->thickness_m);
	for (int32_t k = 0; k < vertices->count; k++) {
		int32_t v = vertices->item[k];
		if (collide->found && is_enough(collide, x, stepping, v, used_up))
			continue;
		double way = stepping ? cau_length(cau_vec3_of(collide->step + 3 * (size_t)v)) : 0;
		double room = stepping ? cau_collide_room(collide, v) : 0;
		anchor(collide, x, v, room + fmax(fmin(foresight * way, most), least));
	}
}

// Only what is asked for, or a share of it. Who knows of more has all of this, so nobody who finds
// that there is no room for it would have had any.
static bool search_least(cau_collide *collide, cau_pool *pool, const double *x, double share)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	for (int32_t k = 0; k < vertices->count; k++) {
		int32_t v = vertices->item[k];
		anchor(collide, x, v, share > 0 ? share * cau_collide_room(collide, v) : 0);
	}
	note_moved(collide);
	memset(collide->surface.changed, 1, (size_t)collide->surface.block_count);
	return search(collide, pool);
}

void cau_collide_find(cau_collide *collide, cau_pool *pool, const double *x, bool stepping)
{
	CAU_ASSERT(collide->surface.listed, "%d faces drawn", collide->surface.faces.count);
	collide->search_count++;
	anchor_used_up(collide, x, stepping);
	note_moved(collide);
	if (!collide->found)
		memset(collide->surface.changed, 1, (size_t)collide->surface.block_count);
	collide->found = true;
	double share = stepping;
	if (search(collide, pool) || search_least(collide, pool, x, share))
		return;
	collide->cut_short_count++;
	for (int tries = 0; tries < TRIES && stepping; tries++)
		if (search_least(collide, pool, x, share /= 2))
			return;
	collide->found = search_least(collide, pool, x, 0); // else not even what touches has room
}

bool cau_collide_covers(const cau_collide *collide, const double *x, bool stepping)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	if (!collide->found)
		return false;
	for (int32_t k = 0; k < vertices->count; k++)
		if (!is_enough(collide, x, stepping, vertices->item[k], 1))
			return false;
	return true;
}

// ---- what has died

void cau_collide_forget_dead(cau_collide *collide)
{
	const cau_primitives *all = &collide->tissue->primitives;
	const int32_t count[] = {all->triangle_count, all->tetrahedron_count, all->link_count};
	const int32_t *vertex[] = {all->triangle, all->tetrahedron, all->link}, corners[] = {3, 4, 2};
	for (int kind = 0; kind < CAU_PRIMITIVE_KINDS; kind++) {
		const uint8_t *alive = collide->alive[kind];
		uint8_t *before = collide->alive_before[kind];
		if (!alive || memcmp(alive, before, (size_t)count[kind]) == 0)
			continue;
		for (int32_t i = 0; i < count[kind]; i++)
			for (int32_t k = 0; k < corners[kind] && alive[i] != before[i]; k++)
				collide->moved[vertex[kind][(size_t)i * (size_t)corners[kind] + (size_t)k]] = 1;
		memcpy(before, alive, (size_t)count[kind]);
	}
	note_moved(collide);
}

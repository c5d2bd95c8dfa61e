// SPDX-License-Identifier: GPL-3.0-or-later
// Broad phase: which pairs may come nearer than their thickness while each vertex stays within its
// reach of where it was anchored. Boxes of parts, grown by what their corners may move, are held
// against boxes of blocks and then against each other.
//
// Pairs live on. A part with a corner that was anchored anew, that lost a joint, or whose face is
// drawn or hidden now (surface->changed) is fresh: its pairs are dropped and looked for again, all
// other pairs are kept. Pairs are ordered by their parts alone, so which pairs touch, and in what
// order, does not depend on when they were found.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "collide/collide.h"

// A pair keeps at most so much of the distance that it has at rest: neighbours, between which the
// surface itself may be drawn together, less than others.
static const double near_share = 0.1, far_share = 0.5;
static const double least_thickness = 0.002; // of the surface's: below, a pair is left out

// ---- parts of a block, by what they are
enum { FACES, EDGES, VERTICES };

typedef struct parts {
	const cau_surface_parts *list;
	cau_collide_box *box;
	const int32_t *corner; // NULL: of itself
	int corners;
} parts;

static parts parts_of(const cau_collide *collide, int what)
{
	const cau_surface *surface = &collide->surface;
	const cau_tissue *tissue = collide->tissue;
	if (what == FACES)
		return (parts){&surface->faces, collide->face_box, tissue->faces.vertex, 3};
	if (what == EDGES)
		return (parts){&surface->edges, collide->edge_box, tissue->edges.vertex, 2};
	return (parts){&surface->vertices, collide->vertex_box, NULL, 1};
}

static const int32_t *corners_of(const parts *p, const int32_t *part)
{
	return p->corner ? p->corner + (size_t)p->corners * (size_t)*part : part;
}

static bool is_fresh(const cau_collide *collide, const parts *p, int32_t part)
{
	const int32_t *corner = corners_of(p, &part);
	uint8_t fresh = 0;
	for (int k = 0; k < p->corners; k++)
		fresh |= collide->surface.changed[corner[k]];
	return fresh;
}

// ---- boxes
static const cau_collide_box nowhere = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};

static double lesser(double a, double b)
{
	return a < b ? a : b;
}

static double greater(double a, double b)
{
	return a > b ? a : b;
}

static cau_collide_box box_round(const cau_collide *collide, const int32_t *vertex, int count)
{
	const double *x = collide->anchor;
	cau_collide_box box = nowhere;
	for (int k = 0; k < count; k++) {
		size_t v = (size_t)vertex[k];
		for (size_t c = 0; c < 3; c++) {
			box.least[c] = lesser(box.least[c], x[3 * v + c] - collide->reach_m[v]);
			box.most[c] = greater(box.most[c], x[3 * v + c] + collide->reach_m[v]);
		}
	}
	return box;
}

static void widen(cau_collide_box *box, const cau_collide_box *by)
{
	for (int c = 0; c < 3; c++) {
		box->least[c] = lesser(box->least[c], by->least[c]);
		box->most[c] = greater(box->most[c], by->most[c]);
	}
}

static bool meets(const cau_collide_box *a, const cau_collide_box *b, double by_m)
{
	return (a->least[0] - by_m <= b->most[0]) & (b->least[0] - by_m <= a->most[0]) &
	       (a->least[1] - by_m <= b->most[1]) & (b->least[1] - by_m <= a->most[1]) &
	       (a->least[2] - by_m <= b->most[2]) & (b->least[2] - by_m <= a->most[2]);
}

// Boxes of a block's fresh parts, of all these, and of all that it has.
static void box_part(void *context, int32_t index)
{
	cau_collide *collide = context;
	int32_t block = collide->touched[index];
	CAU_ASSERT_INDEX(block, collide->surface.block_count);
	for (int what = FACES; what <= VERTICES; what++) {
		parts p = parts_of(collide, what);
		cau_collide_box all = nowhere, fresh = nowhere;
		for (int32_t i = p.list->first[block]; i < p.list->first[block + 1]; i++) {
			int32_t part = p.list->item[i];
			if (is_fresh(collide, &p, part)) {
				p.box[part] = box_round(collide, corners_of(&p, &part), p.corners);
				widen(&fresh, &p.box[part]);
			}
			widen(&all, &p.box[part]);
		}
		collide->block_box[what][block] = all;
		collide->fresh_box[what][block] = fresh;
	}
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
		if (collide->exempt[vertex[i]])
			return false;
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

// Parts of one kind of a block: all that are fresh, or those that meet a box.
typedef struct some_parts {
	int32_t count, item[3 * CAU_SURFACE_FACES];
} some_parts;

static void list_fresh(const cau_collide *collide, int what, int32_t block, some_parts *fresh)
{
	parts p = parts_of(collide, what);
	fresh->count = 0;
	for (int32_t i = p.list->first[block]; i < p.list->first[block + 1]; i++)
		if (is_fresh(collide, &p, p.list->item[i]))
			fresh->item[fresh->count++] = p.list->item[i];
}

static void list_near(const cau_collide *collide, const parts *p, const int32_t *item,
                      int32_t count, const cau_collide_box *within, some_parts *near)
{
	near->count = 0;
	for (int32_t i = 0; i < count; i++)
		if (meets(within, &p->box[item[i]], collide->thickness_m))
			near->item[near->count++] = item[i];
}

static void leave_out(const cau_collide *collide, const parts *p, bool fresh, some_parts *near)
{
	int32_t kept = 0;
	for (int32_t i = 0; i < near->count; i++)
		if (is_fresh(collide, p, near->item[i]) != fresh)
			near->item[kept++] = near->item[i];
	near->count = kept;
}

static void list_near_of(const cau_collide *collide, const parts *p, int32_t block,
                         const cau_collide_box *within, some_parts *near)
{
	int32_t first = p->list->first[block];
	list_near(collide, p, p->list->item + first, p->list->first[block + 1] - first, within, near);
}

// Two blocks of which the first's parts of one kind are held against the second's of another: those
// that are fresh (`fresh`, by kind) against all, or the others (NULL) against those of the second
// that are fresh.
typedef struct meeting {
	parts own, others;
	some_parts own_near, others_near;
} meeting;

static bool meet(const cau_collide *collide, const int32_t block[2], const int what[2],
                 const some_parts *fresh, meeting *m)
{
	cau_collide_box *const *own_box = fresh ? collide->fresh_box : collide->block_box,
						   *const *box = fresh ? collide->block_box : collide->fresh_box;
	const cau_collide_box *own = &own_box[what[0]][block[0]], *others = &box[what[1]][block[1]];
	if (!meets(own, others, collide->thickness_m))
		return false;
	m->own = parts_of(collide, what[0]);
	m->others = parts_of(collide, what[1]);
	list_near_of(collide, &m->others, block[1], own, &m->others_near);
	if (fresh) {
		const some_parts *candidates = &fresh[what[0]];
		list_near(collide, &m->own, candidates->item, candidates->count, others, &m->own_near);
	} else {
		leave_out(collide, &m->others, false, &m->others_near);
		list_near_of(collide, &m->own, block[0], others, &m->own_near);
		leave_out(collide, &m->own, true, &m->own_near);
	}
	return m->own_near.count && m->others_near.count;
}

static void look_at_vertices(cau_collide *collide, int32_t block, int32_t other,
                             const some_parts *fresh)
{
	meeting m;
	if (!meet(collide, (int32_t[]){block, other}, (int[]){VERTICES, FACES}, fresh, &m))
		return;
	for (int32_t i = 0; i < m.own_near.count; i++) {
		int32_t v = m.own_near.item[i];
		for (int32_t j = 0; j < m.others_near.count; j++) {
			cau_collide_found found = {v, m.others_near.item[j], 0, 0};
			const int32_t *c = corners_of(&m.others, &found.second);
			if (meets(&m.own.box[v], &m.others.box[found.second], collide->thickness_m) &&
			    c[0] != v && c[1] != v && c[2] != v &&
			    may_touch(collide, CAU_GAP_VERTEX_FACE, (int32_t[]){v, c[0], c[1], c[2]}, &found))
				list(collide, block, CAU_GAP_VERTEX_FACE, found);
		}
	}
}

// The edge of the lower block first, within a block the lower edge; each pair once.
static void look_at_edges(cau_collide *collide, int32_t block, int32_t other,
                          const some_parts *fresh)
{
	meeting m;
	if (!meet(collide, (int32_t[]){block, other}, (int[]){EDGES, EDGES}, fresh, &m))
		return;
	for (int32_t i = 0; i < m.own_near.count; i++) {
		int32_t e = m.own_near.item[i];
		for (int32_t j = 0; j < m.others_near.count; j++) {
			int32_t f = m.others_near.item[j];
			if (!meets(&m.own.box[e], &m.others.box[f], collide->thickness_m) ||
			    (block == other && f <= e && is_fresh(collide, &m.own, f)))
				continue;
			bool turned = block == other && f < e;
			cau_collide_found found = {turned ? f : e, turned ? e : f, 0, 0};
			const int32_t *a = corners_of(&m.own, &found.first),
						  *b = corners_of(&m.own, &found.second);
			if (a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1] &&
			    may_touch(collide, CAU_GAP_EDGE_EDGE, (int32_t[]){a[0], a[1], b[0], b[1]}, &found))
				list(collide, block, CAU_GAP_EDGE_EDGE, found);
		}
	}
}

static void look_at(cau_collide *collide, int32_t block, int32_t other, const some_parts *fresh)
{
	const cau_collide_box *own = fresh ? collide->fresh_box[FACES] : collide->block_box[FACES],
						  *others = fresh ? collide->block_box[FACES] : collide->fresh_box[FACES];
	if (!meets(&own[block], &others[other], collide->thickness_m)) // which hold all other parts
		return;
	look_at_vertices(collide, block, other, fresh);
	if (other > block || (other == block && fresh))
		look_at_edges(collide, block, other, fresh);
}

static void look_at_fresh(cau_collide *collide, int32_t block)
{
	some_parts fresh[3];
	for (int what = FACES; what <= VERTICES; what++)
		list_fresh(collide, what, block, &fresh[what]);
	for (int32_t other = 0; other < collide->surface.block_count; other++)
		look_at(collide, block, other, fresh);
}

// ---- what a block keeps

// Takes out what it had of parts that are fresh.
static void keep(cau_collide *collide, int32_t block)
{
	cau_collide_slice *slice = &collide->slice[block];
	parts vertices = parts_of(collide, VERTICES), edges = parts_of(collide, EDGES),
		  faces = parts_of(collide, FACES);
	for (int kind = 0; kind < 2; kind++) {
		cau_collide_found *found = collide->list[kind] + (size_t)block * CAU_COLLIDE_SLICE;
		const parts *first = kind == CAU_GAP_VERTEX_FACE ? &vertices : &edges,
					*second = kind == CAU_GAP_VERTEX_FACE ? &faces : &edges;
		int32_t kept = 0;
		for (int32_t k = 0; k < slice->count[kind]; k++)
			if (!is_fresh(collide, first, found[k].first) &&
			    !is_fresh(collide, second, found[k].second))
				found[kept++] = found[k];
		slice->count[kind] = kept;
	}
	slice->full = false;
}

static bool is_before(const cau_collide_found *a, const cau_collide_found *b)
{
	return a->first != b->first ? a->first < b->first : a->second < b->second;
}

// By parts [Shell 1959; gaps of Ciura 2001]: most are in order already.
static void sort(cau_collide_found *found, int32_t count)
{
	static const int32_t gaps[] = {701, 301, 132, 57, 23, 10, 4, 1};
	for (size_t g = 0; g < sizeof gaps / sizeof *gaps; g++)
		for (int32_t gap = gaps[g], i = gap; i < count; i++) {
			cau_collide_found moved = found[i];
			int32_t at = i;
			for (; at >= gap && is_before(&moved, &found[at - gap]); at -= gap)
				found[at] = found[at - gap];
			found[at] = moved;
		}
}

static void search_part(void *context, int32_t block)
{
	cau_collide *collide = context;
	cau_collide_slice *slice = &collide->slice[block];
	CAU_ASSERT_INDEX(block, collide->surface.block_count);
	if (slice->count[0] || slice->count[1])
		keep(collide, block);
	int32_t kept[] = {slice->count[0], slice->count[1]};
	if (collide->is_touched[block])
		look_at_fresh(collide, block);
	for (int32_t k = 0; k < collide->touched_count; k++)
		look_at(collide, block, collide->touched[k], NULL);
	for (int kind = 0; kind < 2; kind++)
		if (slice->count[kind] > kept[kind])
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
					memcpy(pair->vertex + 1,
					       collide->tissue->faces.vertex + 3 * (size_t)found->second,
					       3 * sizeof(int32_t));
				} else {
					memcpy(pair->vertex, collide->tissue->edges.vertex + 2 * (size_t)found->first,
					       2 * sizeof(int32_t));
					memcpy(pair->vertex + 2,
					       collide->tissue->edges.vertex + 2 * (size_t)found->second,
					       2 * sizeof(int32_t));
				}
			}
	return true;
}

// Blocks that list a fresh part.
static void list_touched(cau_collide *collide)
{
	parts faces = parts_of(collide, FACES);
	collide->touched_count = 0;
	for (int32_t b = 0; b < collide->surface.block_count; b++) {
		bool touched = false;
		for (int32_t i = faces.list->first[b]; i < faces.list->first[b + 1] && !touched; i++)
			touched = is_fresh(collide, &faces, faces.list->item[i]);
		collide->is_touched[b] = touched;
		if (touched)
			collide->touched[collide->touched_count++] = b;
	}
}

bool cau_collide_search(cau_collide *collide, cau_pool *pool)
{
	const cau_surface *surface = &collide->surface;
	bool room = true;
	list_touched(collide);
	cau_pool_run(pool, collide->touched_count, box_part, collide);
	cau_pool_run(pool, surface->block_count, search_part, collide);
	for (int32_t b = 0; b < surface->block_count; b++)
		room &= !collide->slice[b].full;
	memset(surface->changed, 0, (size_t)collide->tissue->vertex_count);
	return gather(collide) && room;
}

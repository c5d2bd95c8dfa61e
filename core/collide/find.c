// SPDX-License-Identifier: GPL-3.0-or-later
// Broad phase. Finds the pairs that may come nearer than their thickness while each vertex stays
// within its reach of its anchor. The box of a part is grown by the reach of its corners. Boxes of
// parts are compared with boxes of blocks, then with each other.
//
// Pairs are kept from tick to tick. surface->changed marks vertices that have a new anchor, that
// lost a joining element, or whose face is newly drawn or hidden. A part with such a corner is
// fresh: its pairs are dropped and searched again. All other pairs are kept. Pairs are sorted by
// their parts alone. So which pairs touch, and in what order, does not depend on when they were
// found.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "collide/collide.h"

// ---- parts of a block: faces, edges and vertices
enum { FACES, EDGES, VERTICES };

typedef struct parts {
	const cau_surface_parts *list;
	cau_collide_box *box;
	const int32_t *corner; // NULL: the part is its own corner
	int corners;
} parts;

static parts parts_of(const cau_collide *collide, int what)
{
	const cau_surface *surface = &collide->surface;
	const cau_tissue *tissue = collide->tissue;
	if (what == FACES)
		return (parts){&surface->faces, collide->search.face_box, tissue->faces.vertex, 3};
	if (what == EDGES)
		return (parts){&surface->edges, collide->search.edge_box, tissue->edges.vertex, 2};
	return (parts){&surface->vertices, collide->search.vertex_box, NULL, 1};
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
	const double *x = collide->range.anchor;
	cau_collide_box box = nowhere;
	for (int k = 0; k < count; k++) {
		size_t v = (size_t)vertex[k];
		for (size_t c = 0; c < 3; c++) {
			box.least[c] = lesser(box.least[c], x[3 * v + c] - collide->range.reach_m[v]);
			box.most[c] = greater(box.most[c], x[3 * v + c] + collide->range.reach_m[v]);
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

// Computes the boxes of a block's fresh parts, the box of all fresh parts, and the box of all
// parts.
static void box_part(void *context, int32_t index)
{
	cau_collide *collide = context;
	int32_t block = collide->search.touched[index];
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
		collide->search.block_box[what][block] = all;
		collide->search.fresh_box[what][block] = fresh;
	}
}

// ---- boxes in groups of eight (lanes.h)

static int32_t first_group(const parts *p, int32_t block)
{
	return (p->list->first[block] + CAU_LANES - 1) / CAU_LANES + block;
}

static cau_collide_asking ask(const cau_collide *collide, const cau_collide_box *box)
{
	cau_collide_lanes alone;
	cau_lanes_put(&alone, 0, box->least, box->most, collide->thickness_m);
	return cau_lanes_ask(&alone, 0);
}

static void lay(const cau_collide *collide, int what, int32_t block)
{
	parts p = parts_of(collide, what);
	int32_t end = p.list->first[block + 1], g = first_group(&p, block);
	for (int32_t i = p.list->first[block]; i < end; i += CAU_LANES, g++) {
		int32_t count = end - i < CAU_LANES ? end - i : CAU_LANES;
		collide->search.fresh_lane[what][g] = 0;
		for (int32_t k = 0; k < count; k++) {
			const cau_collide_box *box = &p.box[p.list->item[i + k]];
			cau_lanes_put(&collide->search.lane[what][g], k, box->least, box->most,
			              collide->thickness_m);
			collide->search.fresh_lane[what][g] |=
				(uint8_t)(is_fresh(collide, &p, p.list->item[i + k]) << k);
		}
		cau_lanes_close(&collide->search.lane[what][g], count);
	}
}

static void lay_touched(void *context, int32_t index)
{
	cau_collide *collide = context;
	for (int what = FACES; what <= VERTICES; what++)
		lay(collide, what, collide->search.touched[index]);
}

static void lay_block(void *context, int32_t block)
{
	cau_collide *collide = context;
	for (int what = FACES; what <= VERTICES; what++)
		lay(collide, what, block);
}

// Whether any block's list begins at another index than when the groups were laid out. If not, only
// touched blocks list other parts than before.
static bool begin_elsewhere(cau_collide *collide)
{
	bool elsewhere = false;
	for (int what = FACES; what <= VERTICES; what++) {
		size_t bytes = ((size_t)collide->surface.block_count + 1) * sizeof(int32_t);
		const int32_t *first = parts_of(collide, what).list->first;
		elsewhere |= memcmp(collide->search.lane_first[what], first, bytes) != 0;
		memcpy(collide->search.lane_first[what], first, bytes);
	}
	return elsewhere;
}

static void lay_boxes(const cau_collide *collide, cau_collide_lanes *to, const int32_t *block,
                      int32_t count, const cau_collide_box *box)
{
	for (int32_t k = 0; k < count; k++) {
		const cau_collide_box *of = &box[block ? block[k] : k];
		cau_lanes_put(&to[k / CAU_LANES], k % CAU_LANES, of->least, of->most, collide->thickness_m);
	}
	cau_lanes_close(&to[count / CAU_LANES], count % CAU_LANES);
}

static void lay_out(cau_collide *collide, cau_pool *pool)
{
	int32_t blocks = collide->surface.block_count;
	if (begin_elsewhere(collide))
		cau_pool_run(pool, blocks, lay_block, collide);
	else
		cau_pool_run(pool, collide->search.touched_count, lay_touched, collide);
	lay_boxes(collide, collide->search.block_lane, NULL, blocks, collide->search.block_box[FACES]);
	lay_boxes(collide, collide->search.touched_lane, collide->search.touched,
	          collide->search.touched_count, collide->search.fresh_box[FACES]);
}

// ---- pairs

// Whether this search may stop as soon as it fails. A search that exceeds the capacity is repeated
// with a smaller reach of all vertices (reach.c), and its pairs are not used. But a search with no
// reach at all is the last one: its pairs are used.
static bool may_give_up(const cau_collide *collide)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	for (int32_t k = 0; k < vertices->count; k++)
		if (collide->range.reach_m[vertices->item[k]] > 0)
			return true;
	return false;
}

static bool gives_up(const cau_collide *collide)
{
	return collide->search.may_give_up &&
	       atomic_load_explicit(&collide->search.fails, memory_order_relaxed);
}

static void list(cau_collide *collide, int32_t block, cau_gap_kind kind, cau_collide_found found)
{
	cau_collide_slice *slice = &collide->search.slice[block];
	if (slice->count[kind] == CAU_COLLIDE_SLICE) {
		slice->full = true;
		collide->search.fails = true;
		return;
	}
	collide->search.list[kind][(size_t)block * CAU_COLLIDE_SLICE + (size_t)slice->count[kind]++] =
		found;
}

// Parts of a block that are near another block, with their boxes.
typedef struct near_parts {
	int32_t count, item[3 * CAU_SURFACE_FACES];
	cau_collide_lanes lane[3 * CAU_SURFACE_FACES / CAU_LANES + 1];
} near_parts;

typedef enum wanted_parts { ALL, FRESH, NOT_FRESH } wanted_parts;

static uint32_t wanted_of(const cau_collide *collide, int what, int32_t block, int32_t group,
                          wanted_parts wanted)
{
	uint32_t fresh =
		collide->search.is_touched[block] ? collide->search.fresh_lane[what][group] : 0;
	return wanted == ALL ? ~0U : wanted == FRESH ? fresh : ~fresh;
}

static void take(near_parts *near, int32_t item, const cau_collide_lanes *from, int lane)
{
	cau_lanes_copy(&near->lane[near->count / CAU_LANES], near->count % CAU_LANES, from, lane);
	near->item[near->count++] = item;
}

static bool list_near(const cau_collide *collide, int what, int32_t block, wanted_parts wanted,
                      const cau_collide_box *within, near_parts *near)
{
	parts p = parts_of(collide, what);
	int32_t first = first_group(&p, block), end = p.list->first[block + 1];
	cau_collide_asking asking = ask(collide, within);
	near->count = 0;
	for (int32_t i = p.list->first[block], g = first; i < end; i += CAU_LANES, g++) {
		const cau_collide_lanes *group = &collide->search.lane[what][g];
		uint32_t met = cau_lanes_meet(group, &asking) & wanted_of(collide, what, block, g, wanted);
		for (; met; met &= met - 1)
			take(near, p.list->item[i + __builtin_ctz(met)], group, __builtin_ctz(met));
	}
	cau_lanes_close(&near->lane[near->count / CAU_LANES], near->count % CAU_LANES);
	return near->count > 0;
}

// Two lists to compare: `own` has parts of one kind in the first block, `others` parts of one kind
// in the second block. Only parts near the other block are listed. If `own` lists fresh parts,
// `others` lists all parts, otherwise only fresh parts.
typedef struct meeting {
	near_parts own, others;
} meeting;

static bool meet(const cau_collide *collide, const int32_t block[2], const int what[2], bool fresh,
                 meeting *m)
{
	cau_collide_box *const *own_box = fresh ? collide->search.fresh_box : collide->search.block_box,
						   *const *box =
							   fresh ? collide->search.block_box : collide->search.fresh_box;
	const cau_collide_box *own = &own_box[what[0]][block[0]], *others = &box[what[1]][block[1]];
	return meets(own, others, collide->thickness_m) &&
	       list_near(collide, what[0], block[0], fresh ? FRESH : NOT_FRESH, others, &m->own) &&
	       list_near(collide, what[1], block[1], fresh ? ALL : FRESH, own, &m->others);
}

static bool shares_corner(const int32_t *a, int a_count, const int32_t *b, int b_count)
{
	bool shares = false;
	for (int i = 0; i < a_count; i++)
		for (int j = 0; j < b_count; j++)
			shares |= a[i] == b[j];
	return shares;
}

// Lists a vertex and a face as a pair if they may touch. Their boxes meet in single precision. The
// test in double precision comes last, because it seldom fails.
static void look_at_vertex(cau_collide *collide, int32_t block, int32_t v, int32_t face)
{
	cau_collide_found found = {v, face, 0, 0};
	const int32_t *c = collide->tissue->faces.vertex + 3 * (size_t)face;
	if (!shares_corner(&v, 1, c, 3) &&
	    cau_collide_may_touch(collide, CAU_GAP_VERTEX_FACE, (int32_t[]){v, c[0], c[1], c[2]},
	                          &found) &&
	    meets(&collide->search.vertex_box[v], &collide->search.face_box[face],
	          collide->thickness_m))
		list(collide, block, CAU_GAP_VERTEX_FACE, found);
}

static void look_at_edge(cau_collide *collide, int32_t block, int32_t e, int32_t f)
{
	cau_collide_found found = {e, f, 0, 0};
	const int32_t *a = collide->tissue->edges.vertex + 2 * (size_t)e;
	const int32_t *b = collide->tissue->edges.vertex + 2 * (size_t)f;
	if (!shares_corner(a, 2, b, 2) &&
	    cau_collide_may_touch(collide, CAU_GAP_EDGE_EDGE, (int32_t[]){a[0], a[1], b[0], b[1]},
	                          &found) &&
	    meets(&collide->search.edge_box[e], &collide->search.edge_box[f], collide->thickness_m))
		list(collide, block, CAU_GAP_EDGE_EDGE, found);
}

static void look_at_vertices(cau_collide *collide, int32_t block, int32_t other, bool fresh)
{
	meeting m;
	if (!meet(collide, (int32_t[]){block, other}, (int[]){VERTICES, FACES}, fresh, &m))
		return;
	for (int32_t i = 0; i < m.own.count; i++) {
		cau_collide_asking asking = cau_lanes_ask(&m.own.lane[i / CAU_LANES], i % CAU_LANES);
		for (int32_t j = 0; j < m.others.count; j += CAU_LANES)
			for (uint32_t met = cau_lanes_meet(&m.others.lane[j / CAU_LANES], &asking); met;
			     met &= met - 1)
				look_at_vertex(collide, block, m.own.item[i],
				               m.others.item[j + __builtin_ctz(met)]);
	}
}

// Lists pairs of edges, each pair once. First comes the edge of the block with the lower index or,
// within a block, the edge with the lower index.
static void look_at_edges(cau_collide *collide, int32_t block, int32_t other, bool fresh)
{
	parts edges = parts_of(collide, EDGES);
	meeting m;
	if (!meet(collide, (int32_t[]){block, other}, (int[]){EDGES, EDGES}, fresh, &m))
		return;
	for (int32_t i = 0; i < m.own.count; i++) {
		int32_t e = m.own.item[i];
		cau_collide_asking asking = cau_lanes_ask(&m.own.lane[i / CAU_LANES], i % CAU_LANES);
		for (int32_t j = 0; j < m.others.count; j += CAU_LANES)
			for (uint32_t met = cau_lanes_meet(&m.others.lane[j / CAU_LANES], &asking); met;
			     met &= met - 1) {
				int32_t f = m.others.item[j + __builtin_ctz(met)];
				if (block != other || f > e)
					look_at_edge(collide, block, e, f);
				else if (!is_fresh(collide, &edges, f))
					look_at_edge(collide, block, f, e);
			}
	}
}

static void look_at(cau_collide *collide, int32_t block, int32_t other, bool fresh)
{
	look_at_vertices(collide, block, other, fresh);
	if (other > block || (other == block && fresh))
		look_at_edges(collide, block, other, fresh);
}

static void look_at_fresh(cau_collide *collide, int32_t block)
{
	cau_collide_asking asking = ask(collide, &collide->search.fresh_box[FACES][block]);
	for (int32_t b = 0; b < collide->surface.block_count; b += CAU_LANES)
		for (uint32_t met = cau_lanes_meet(&collide->search.block_lane[b / CAU_LANES], &asking);
		     met && !gives_up(collide); met &= met - 1)
			look_at(collide, block, b + __builtin_ctz(met), true);
}

static void look_at_others(cau_collide *collide, int32_t block)
{
	cau_collide_asking asking = ask(collide, &collide->search.block_box[FACES][block]);
	for (int32_t k = 0; k < collide->search.touched_count; k += CAU_LANES)
		for (uint32_t met = cau_lanes_meet(&collide->search.touched_lane[k / CAU_LANES], &asking);
		     met && !gives_up(collide); met &= met - 1)
			look_at(collide, block, collide->search.touched[k + __builtin_ctz(met)], false);
}

// ---- pairs that a block keeps

// Removes the block's pairs that have a fresh part.
static void keep(cau_collide *collide, int32_t block)
{
	cau_collide_slice *slice = &collide->search.slice[block];
	parts vertices = parts_of(collide, VERTICES), edges = parts_of(collide, EDGES),
		  faces = parts_of(collide, FACES);
	for (int kind = 0; kind < 2; kind++) {
		cau_collide_found *found = collide->search.list[kind] + (size_t)block * CAU_COLLIDE_SLICE;
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

static void search_part(void *context, int32_t block)
{
	cau_collide *collide = context;
	cau_collide_slice *slice = &collide->search.slice[block];
	CAU_ASSERT_INDEX(block, collide->surface.block_count);
	if (gives_up(collide))
		return;
	if (slice->count[0] || slice->count[1])
		keep(collide, block);
	int32_t kept[] = {slice->count[0], slice->count[1]};
	if (collide->search.is_touched[block])
		look_at_fresh(collide, block);
	look_at_others(collide, block);
	for (int kind = 0; kind < 2; kind++)
		if (slice->count[kind] > kept[kind])
			cau_collide_sort(collide->search.list[kind] + (size_t)block * CAU_COLLIDE_SLICE,
			                 slice->count[kind]);
	int32_t count = slice->count[0] + slice->count[1];
	if (atomic_fetch_add(&collide->search.listed_count, count) + count > collide->most_pairs)
		collide->search.fails = true;
}

// Lists the blocks that have a fresh face.
static void list_touched(cau_collide *collide)
{
	parts faces = parts_of(collide, FACES);
	collide->search.touched_count = 0;
	for (int32_t b = 0; b < collide->surface.block_count; b++) {
		bool touched = false;
		for (int32_t i = faces.list->first[b]; i < faces.list->first[b + 1] && !touched; i++)
			touched = is_fresh(collide, &faces, faces.list->item[i]);
		collide->search.is_touched[b] = touched;
		if (touched)
			collide->search.touched[collide->search.touched_count++] = b;
	}
}

bool cau_collide_search(cau_collide *collide, cau_pool *pool)
{
	list_touched(collide);
	cau_pool_run(pool, collide->search.touched_count, box_part, collide);
	lay_out(collide, pool);
	collide->search.may_give_up = may_give_up(collide);
	collide->search.fails = false;
	collide->search.listed_count = 0;
	cau_pool_run(pool, collide->surface.block_count, search_part, collide);
	memset(collide->surface.changed, 0, (size_t)collide->tissue->vertex_count);
	bool room = !collide->search.fails;
	if (room || !collide->search.may_give_up)
		cau_collide_gather(collide);
	return room;
}

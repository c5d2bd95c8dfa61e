// SPDX-License-Identifier: GPL-3.0-or-later
// Isosurface stuffing [Labelle and Shewchuk 2007] in passes. The first pass cuts the tissue of all
// labels out of the lattice. Each further pass cuts one label out of the tissue. In each pass:
// - vertices are inside (1), outside (-1), or on the interface (0);
// - an edge from inside to outside is cut where the label changes. A vertex near this point moves
//   there if the tetrahedra around it stay good. Then its edges are not cut;
// - tetrahedra with a cut edge are divided. Parts inside get the label of the pass.
// A later pass may divide faces of tetrahedra with an earlier label. These tetrahedra are then
// divided too.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/geometry.h"
#include "solid/mesher.h"

enum { HALVINGS = 12 };
// Distance, as a share of an edge's length, within which a vertex moves to the cut.
static const double snap_share = 0.35;
// Least distance of a cut from an edge's ends, as a share of the edge's length.
static const double cut_least = 0.06;
static const double still_good = 0.2; // least quality that a move may leave

// A cut of an edge from inside to outside.
typedef struct cut {
	int32_t in, out;
	double share;   // position along the edge, as a share of its length from `in`
	int32_t vertex; // the vertex at the cut; -1: not made yet
} cut;

typedef struct pass {
	const cau_domain *domain;
	cau_tets *tets;
	int32_t label;           // 0: all labels
	int32_t inside, outside; // labels that the two sides get
	const bool *passed;
	int8_t *sign; // (number of vertices before the pass): 1, 0, -1; 2: not known
	cut *cuts;
	int32_t cut_count, cut_capacity;
	int32_t *slot; // hash table of edges: index of a cut, or -1
	uint32_t slot_mask;
} pass;

// ---- cuts
static uint32_t hash_of(int32_t a, int32_t b)
{
	uint64_t key = (uint64_t)(uint32_t)(a < b ? a : b) << 32 | (uint32_t)(a < b ? b : a);
	key *= 0x9e3779b97f4a7c15u;
	return (uint32_t)(key >> 32);
}

// Returns the slot of an edge in the hash table. The slot may be empty.
static int32_t *slot_of(const pass *of, int32_t a, int32_t b)
{
	for (uint32_t at = hash_of(a, b);; at++) {
		int32_t *slot = &of->slot[at & of->slot_mask];
		const cut *own = *slot < 0 ? NULL : &of->cuts[*slot];
		if (!own || (own->in == a && own->out == b) || (own->in == b && own->out == a))
			return slot;
	}
}

// Makes a hash table of `slots` slots. If memory runs out, the old table stays. It is needed for
// searches until the pass ends.
static bool rehash(pass *of, uint32_t slots)
{
	int32_t *slot = malloc(slots * sizeof *slot);
	if (!slot)
		return false;
	free(of->slot);
	of->slot = slot;
	of->slot_mask = slots - 1;
	for (uint32_t i = 0; i < slots; i++)
		of->slot[i] = -1;
	for (int32_t i = 0; i < of->cut_count; i++)
		*slot_of(of, of->cuts[i].in, of->cuts[i].out) = i;
	return true;
}

static void add_cut(pass *of, int32_t in, int32_t out)
{
	int32_t *slot = slot_of(of, in, out);
	if (*slot >= 0)
		return;
	if (of->cut_count == of->cut_capacity) {
		int32_t wanted = 2 * of->cut_capacity;
		cut *more = realloc(of->cuts, (size_t)wanted * sizeof *more);
		of->cuts = more ? more : of->cuts;
		of->tets->failed |= !more || !rehash(of, 4 * (uint32_t)wanted);
		if (of->tets->failed)
			return;
		of->cut_capacity = wanted;
		slot = slot_of(of, in, out);
	}
	*slot = of->cut_count;
	of->cuts[of->cut_count++] = (cut){.in = in, .out = out, .vertex = -1};
}

static bool is_inside(const pass *of, const double x[3])
{
	int32_t label = of->domain->label_at(of->domain, x, of->passed);
	return of->label ? label == of->label : label != 0;
}

static void point_on(const cau_tets *tets, const cut *of, double share, double x[3])
{
	const double *in = tets->position + 3 * (size_t)of->in;
	const double *out = tets->position + 3 * (size_t)of->out;
	for (int c = 0; c < 3; c++)
		x[c] = in[c] + share * (out[c] - in[c]);
}

// Finds the position on the edge at which the label ends.
static void find_place(const pass *of, cut *at)
{
	double in = 0, out = 1;
	for (int k = 0; k < HALVINGS; k++) {
		double x[3], middle = (in + out) / 2;
		point_on(of->tets, at, middle, x);
		bool inside = is_inside(of, x);
		in = inside ? middle : in;
		out = inside ? out : middle;
	}
	at->share = (in + out) / 2;
}

static void find_sign(pass *of, int32_t vertex)
{
	const double *x = of->tets->position + 3 * (size_t)vertex;
	if (of->sign[vertex] == 2)
		of->sign[vertex] = is_inside(of, x) ? 1 : -1;
}

static void add_cuts(pass *of, const int32_t vertex[4])
{
	for (int a = 0; a < 4; a++)
		for (int b = 0; b < 4; b++)
			if (a != b && of->sign[vertex[a]] > 0 && of->sign[vertex[b]] < 0)
				add_cut(of, vertex[a], vertex[b]);
}

static bool has_cut_edge(const pass *of, const int32_t vertex[4])
{
	for (int a = 0; a < 4; a++)
		for (int b = 0; b < a; b++) {
			bool changes = of->sign[vertex[a]] * of->sign[vertex[b]] == -1;
			if (changes && *slot_of(of, vertex[a], vertex[b]) >= 0)
				return true;
		}
	return false;
}

// Completes the cuts. A face of a tetrahedron with an earlier label may be divided. The other
// corners of this tetrahedron then count as on the interface, and each of its edges that changes
// sign is cut too. This may divide further tetrahedra, so the search is repeated.
static void complete(pass *of)
{
	const cau_tets *tets = of->tets;
	for (int32_t before = -1; before != of->cut_count && !tets->failed;) {
		before = of->cut_count;
		for (int32_t i = 0; i < tets->count && !tets->failed; i++) {
			const int32_t *vertex = tets->vertex + 4 * (size_t)i;
			if (tets->label[i] == CAU_UNDECIDED || !has_cut_edge(of, vertex))
				continue;
			for (int k = 0; k < 4; k++)
				of->sign[vertex[k]] = of->sign[vertex[k]] == 2 ? 0 : of->sign[vertex[k]];
			add_cuts(of, vertex);
		}
	}
}

static void find_cuts(pass *of)
{
	const cau_tets *tets = of->tets;
	for (int32_t i = 0; i < tets->count && !tets->failed; i++) {
		const int32_t *vertex = tets->vertex + 4 * (size_t)i;
		if (tets->label[i] != CAU_UNDECIDED)
			continue;
		for (int k = 0; k < 4; k++)
			find_sign(of, vertex[k]);
		add_cuts(of, vertex);
	}
	complete(of);
	for (int32_t i = 0; i < of->cut_count && !tets->failed; i++)
		find_place(of, &of->cuts[i]);
}

// ---- moving vertices onto the interface
typedef struct snap {
	int32_t vertex, cut;
	double share; // distance to move, as a share of the edge from the vertex
} snap;

static int nearer(const void *a, const void *b)
{
	const snap *x = a, *y = b;
	if (x->share != y->share)
		return x->share < y->share ? -1 : 1;
	return x->cut != y->cut ? (x->cut > y->cut) - (x->cut < y->cut)
	                        : (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static void try_snap(pass *of, const cau_around *around, const snap *at)
{
	cau_tets *tets = of->tets;
	const cut *edge = &of->cuts[at->cut];
	int32_t other = at->vertex == edge->in ? edge->out : edge->in;
	double *x = tets->position + 3 * (size_t)at->vertex, before[3], place[3];
	bool leaves = tets->on_interface[at->vertex] && !tets->on_interface[other];
	if (!of->sign[at->vertex] || !of->sign[other] || leaves)
		return;
	point_on(tets, edge, edge->share, place);
	double was = cau_least_around(tets, around, at->vertex, -1);
	memcpy(before, x, sizeof before);
	memcpy(x, place, sizeof place);
	double is = cau_least_around(tets, around, at->vertex, -1);
	if (is >= fmin(was, still_good) && is > 0)
		of->sign[at->vertex] = 0;
	else
		memcpy(x, before, sizeof before);
}

// Moves vertices to near cuts, the nearest first.
static void snap_all(pass *of)
{
	cau_around around = {0};
	int32_t count = 0;
	snap *list = malloc(((size_t)of->cut_count * 2 + 1) * sizeof *list);
	of->tets->failed |= !list || !cau_around_make(&around, of->tets->vertex, of->tets->count, 4,
	                                              of->tets->vertex_count);
	for (int32_t i = 0; i < of->cut_count && !of->tets->failed; i++) {
		const cut *at = &of->cuts[i];
		if (at->share <= snap_share)
			list[count++] = (snap){at->in, i, at->share};
		if (1 - at->share <= snap_share)
			list[count++] = (snap){at->out, i, 1 - at->share};
	}
	if (count)
		qsort(list, (size_t)count, sizeof *list, nearer);
	for (int32_t i = 0; i < count; i++)
		try_snap(of, &around, &list[i]);
	cau_around_finish(&around);
	free(list);
}

// ---- dividing
static int32_t cut_vertex(pass *of, int32_t in, int32_t out)
{
	int32_t slot = *slot_of(of, in, out);
	CAU_ASSERT_INDEX(slot, of->cut_count);
	cut *at = &of->cuts[slot];
	if (at->vertex < 0) {
		double x[3];
		point_on(of->tets, at, fmin(fmax(at->share, cut_least), 1 - cut_least), x);
		at->vertex = cau_tets_vertex(of->tets, x, true);
	}
	return at->vertex;
}

// Adds a pyramid over the quadrangle a b c d. Its diagonal starts at the vertex with the lowest
// index, so that neighbours choose the same diagonal [Dompierre et al. 1999].
static void add_pyramid(pass *of, const int32_t base[4], int32_t apex, int32_t label)
{
	int low = 0;
	for (int k = 1; k < 4; k++)
		low = base[k] < base[low] ? k : low;
	for (int k = 1; k < 3; k++)
		cau_tets_add(
			of->tets,
			(const int32_t[4]){base[low], base[(low + k) % 4], base[(low + k + 1) % 4], apex},
			label);
}

// Divides the prism between triangles a and b, with edges from a[k] to b[k], into a tetrahedron and
// a pyramid. Their apex is the vertex with the lowest index. The triangle without the apex is the
// base of the tetrahedron. The quadrangle without the apex is the base of the pyramid.
static void add_prism(pass *of, const int32_t a[3], const int32_t b[3], int32_t label)
{
	int low = 0;
	for (int k = 1; k < 6; k++)
		low = (k < 3 ? a[k] : b[k - 3]) < (low < 3 ? a[low] : b[low - 3]) ? k : low;
	const int32_t *near = low < 3 ? a : b, *far = low < 3 ? b : a;
	int own = low % 3, u = (own + 1) % 3, v = (own + 2) % 3;
	cau_tets_add(of->tets, (const int32_t[4]){near[own], far[0], far[1], far[2]}, label);
	add_pyramid(of, (const int32_t[4]){near[u], near[v], far[v], far[u]}, near[own], label);
}

// The corners of a tetrahedron, grouped by sign.
typedef struct sides {
	int32_t in[4], out[4], on[4];
	int ins, outs, ons;
} sides;

static sides sides_of(const pass *of, const int32_t vertex[4])
{
	sides at = {0};
	for (int k = 0; k < 4; k++) {
		int8_t sign = of->sign[vertex[k]];
		if (sign == 0)
			at.on[at.ons++] = vertex[k];
		else if (sign > 0)
			at.in[at.ins++] = vertex[k];
		else
			at.out[at.outs++] = vertex[k];
	}
	return at;
}

// Cuts off the tip of a tetrahedron. The tip is the only corner on its side; `count` corners are on
// the other side.
static void divide_tip(pass *of, int32_t tip, const int32_t *others, int count, const int32_t *on,
                       int32_t tip_label, int32_t label)
{
	int32_t c[3] = {0};
	CAU_ASSERT(count >= 1 && count <= 3, "a tip against %d corners", count);
	for (int k = 0; k < count; k++)
		c[k] = cut_vertex(of, tip, others[k]);
	if (count == 1) {
		cau_tets_add(of->tets, (const int32_t[4]){tip, c[0], on[0], on[1]}, tip_label);
		cau_tets_add(of->tets, (const int32_t[4]){others[0], c[0], on[0], on[1]}, label);
	} else if (count == 2) {
		cau_tets_add(of->tets, (const int32_t[4]){tip, c[0], c[1], on[0]}, tip_label);
		add_pyramid(of, (const int32_t[4]){others[0], others[1], c[1], c[0]}, on[0], label);
	} else {
		cau_tets_add(of->tets, (const int32_t[4]){tip, c[0], c[1], c[2]}, tip_label);
		add_prism(of, others, c, label);
	}
}

static void divide_middle(pass *of, const sides *at, int32_t inside, int32_t outside)
{
	int32_t c[2][2]; // vertices at the cuts from in[i] to out[j]
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++)
			c[i][j] = cut_vertex(of, at->in[i], at->out[j]);
	add_prism(of, (const int32_t[3]){at->in[0], c[0][0], c[0][1]},
	          (const int32_t[3]){at->in[1], c[1][0], c[1][1]}, inside);
	add_prism(of, (const int32_t[3]){at->out[0], c[0][0], c[1][0]},
	          (const int32_t[3]){at->out[1], c[0][1], c[1][1]}, outside);
}

// Divides one tetrahedron. Returns true if the parts replace it. A tetrahedron of an earlier label
// is divided because its neighbours are divided, and keeps its label.
static bool divide(pass *of, const int32_t vertex[4], int32_t own)
{
	sides at = sides_of(of, vertex);
	int32_t inside = own == CAU_UNDECIDED ? of->inside : own;
	int32_t outside = own == CAU_UNDECIDED ? of->outside : own;
	if (!at.ins || !at.outs)
		return false;
	if (at.ins == 1)
		divide_tip(of, at.in[0], at.out, at.outs, at.on, inside, outside);
	else if (at.outs == 1)
		divide_tip(of, at.out[0], at.in, at.ins, at.on, outside, inside);
	else
		divide_middle(of, &at, inside, outside);
	return true;
}

// Returns the label of a tetrahedron whose corners are all on the interface. Its middle decides.
static int32_t label_of_flat(const pass *of, const int32_t vertex[4])
{
	double x[3] = {0};
	for (int k = 0; k < 12; k++)
		x[k % 3] += of->tets->position[3 * (size_t)vertex[k / 3] + (size_t)(k % 3)] / 4;
	return is_inside(of, x) ? of->inside : of->outside;
}

static int32_t label_of_whole(const pass *of, const int32_t vertex[4])
{
	sides at = sides_of(of, vertex);
	if (at.ons == 4)
		return label_of_flat(of, vertex);
	return at.ins ? of->inside : of->outside;
}

static void divide_all(pass *of)
{
	cau_tets *tets = of->tets;
	int32_t before = tets->count, kept = 0;
	for (int32_t i = 0; i < before && !tets->failed; i++) {
		int32_t vertex[4], label = tets->label[i];
		memcpy(vertex, tets->vertex + 4 * (size_t)i, sizeof vertex);
		bool decided = label != CAU_UNDECIDED;
		bool gone = (!decided || has_cut_edge(of, vertex)) && divide(of, vertex, label);
		if (gone)
			continue;
		memcpy(tets->vertex + 4 * (size_t)kept, vertex, sizeof vertex);
		tets->label[kept++] = decided ? label : label_of_whole(of, vertex);
	}
	if (tets->failed)
		return;
	int32_t added = tets->count - before;
	memmove(tets->vertex + 4 * (size_t)kept, tets->vertex + 4 * (size_t)before,
	        4 * (size_t)added * sizeof *tets->vertex);
	memmove(tets->label + kept, tets->label + before, (size_t)added * sizeof *tets->label);
	tets->count = kept + added;
}

// ---- passes
static void run(pass *of)
{
	cau_tets *tets = of->tets;
	of->cut_capacity = 4096;
	of->sign = malloc((size_t)tets->vertex_count + 1);
	of->cuts = malloc((size_t)of->cut_capacity * sizeof *of->cuts);
	tets->failed |= !of->sign || !of->cuts || !rehash(of, 4 * (uint32_t)of->cut_capacity);
	if (tets->failed)
		return;
	memset(of->sign, 2, (size_t)tets->vertex_count);
	int32_t vertex_count = tets->vertex_count;
	find_cuts(of);
	if (!tets->failed)
		snap_all(of);
	if (!tets->failed)
		divide_all(of);
	for (int32_t v = 0; v < vertex_count && !tets->failed; v++)
		tets->on_interface[v] |= of->sign[v] == 0;
}

// Removes the tetrahedra that are outside, and the vertices that no other tetrahedron uses.
static cau_status compact(cau_tets *tets, cau_error *error)
{
	int32_t *map = malloc(((size_t)tets->vertex_count + 1) * sizeof *map), kept = 0, vertices = 0;
	if (!map)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %d vertices",
		                tets->vertex_count);
	for (int32_t v = 0; v < tets->vertex_count; v++)
		map[v] = -1;
	for (int32_t i = 0; i < tets->count; i++) {
		if (tets->label[i] == 0)
			continue;
		for (int k = 0; k < 4; k++)
			map[tets->vertex[4 * (size_t)i + (size_t)k]] = 0;
		memmove(tets->vertex + 4 * (size_t)kept, tets->vertex + 4 * (size_t)i,
		        4 * sizeof *tets->vertex);
		tets->label[kept++] = tets->label[i];
	}
	for (int32_t v = 0; v < tets->vertex_count; v++)
		if (map[v] == 0) {
			memmove(tets->position + 3 * (size_t)vertices, tets->position + 3 * (size_t)v,
			        3 * sizeof *tets->position);
			tets->on_interface[vertices] = tets->on_interface[v];
			map[v] = vertices++;
		}
	for (size_t i = 0; i < 4 * (size_t)kept; i++)
		tets->vertex[i] = map[tets->vertex[i]];
	tets->count = kept;
	tets->vertex_count = vertices;
	free(map);
	return CAU_OK;
}

static cau_status run_pass(pass of, cau_error *error)
{
	if (!of.tets->count)
		return CAU_OK; // the lattice is empty, so nothing is cut
	run(&of);
	free(of.sign);
	free(of.cuts);
	free(of.slot);
	return of.tets->failed
	           ? cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %d tetrahedra", of.tets->count)
	           : compact(of.tets, error);
}

cau_status cau_stuff(const cau_domain *domain, cau_tets *tets,
                     void (*progress)(void *user, double share), void *user, cau_error *error)
{
	bool passed[CAU_SOLID_LABEL_MAX + 1] = {0};
	int32_t last = domain->label_count;
	CAU_ASSERT(last >= 1 && last <= CAU_SOLID_LABEL_MAX, "%d labels", last);
	cau_status status = run_pass(
		(pass){.domain = domain, .tets = tets, .passed = passed, .inside = CAU_UNDECIDED}, error);
	passed[0] = true; // from here on all tetrahedra are tissue
	for (int32_t label = 1; label < last && !status; label++) {
		progress(user, (double)label / last);
		status = run_pass((pass){.domain = domain,
		                         .tets = tets,
		                         .label = label,
		                         .passed = passed,
		                         .inside = label,
		                         .outside = CAU_UNDECIDED},
		                  error);
		passed[label] = true;
	}
	for (int32_t i = 0; i < tets->count && !status; i++)
		tets->label[i] = tets->label[i] == CAU_UNDECIDED ? last : tets->label[i];
	progress(user, 1);
	return status;
}

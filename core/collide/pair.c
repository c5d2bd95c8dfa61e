// SPDX-License-Identifier: GPL-3.0-or-later
// Decides which parts form a pair, and whether they may come near each other. All parts whose boxes
// meet are tested (find.c). So cheap tests that exclude most pairs come first.
#include <math.h>

#include "cautery/assert.h"
#include "collide/collide.h"

// Largest thickness of a pair, as a share of its distance at rest. Neighbours, between which the
// surface itself may contract, have the smaller share.
static const double near_share = 0.1, far_share = 0.5;
// Least thickness of a pair, as a share of the surface's thickness. A pair of less thickness is
// left out.
static const double least_thickness = 0.002;
// Factor on a distance that exceeds any rounding of the distance.
static const double surely = 1 + 1e-6;

// Each kind of pair is compiled by itself, with the kind as a constant.
#define INLINE static inline __attribute__((always_inline))

static double lesser(double a, double b)
{
	return a < b ? a : b;
}

static double greater(double a, double b)
{
	return a > b ? a : b;
}

static bool is_shared(const cau_collide *collide, int kind, int32_t edge)
{
	const cau_edge_table *edges = &collide->tissue->edges;
	CAU_ASSERT_INDEX(edge, edges->edge_count);
	for (int32_t k = edges->first[kind][edge]; k < edges->first[kind][edge + 1]; k++)
		if (!collide->alive[kind] || collide->alive[kind][edges->sharer[kind][k]])
			return true;
	return false;
}

// Whether vertices are near enough at rest to be joined by an edge.
static bool may_be_joined(const cau_collide *collide, int32_t v, int32_t w)
{
	const double *rest = collide->tissue->rest;
	cau_vec3 way = cau_sub(cau_vec3_of(rest + 3 * (size_t)v), cau_vec3_of(rest + 3 * (size_t)w));
	double most = surely * lesser(collide->longest_m[v], collide->longest_m[w]);
	return cau_dot(way, way) <= most * most;
}

// Returns the share of its distance at rest that the pair keeps: near_share if a live element joins
// its parts, else far_share.
static double share_of(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4])
{
	int firsts = cau_gap_first(kind);
	for (int i = 0; i < firsts; i++)
		for (int j = firsts; j < 4; j++) {
			if (!may_be_joined(collide, vertex[i], vertex[j]))
				continue;
			int32_t edge = cau_edge_table_find(&collide->tissue->edges, vertex[i], vertex[j]);
			for (int k = 0; k < CAU_PRIMITIVE_KINDS && edge >= 0; k++)
				if (is_shared(collide, k, edge))
					return near_share;
		}
	return far_share;
}

// Whether the parts may be no farther apart than `most`. Measures only along the line between their
// middles, which excludes most pairs.
INLINE bool is_within(cau_gap_kind kind, const cau_vec3 corner[4], double most)
{
	int firsts = cau_gap_first(kind);
	cau_vec3 middle[2] = {{0, 0, 0}, {0, 0, 0}};
	for (int i = 0; i < 4; i++)
		middle[i >= firsts] = cau_add_scaled(middle[i >= firsts],
		                                     1.0 / (i >= firsts ? 4 - firsts : firsts), corner[i]);
	cau_vec3 way = cau_sub(middle[0], middle[1]);
	return !(cau_gap_along(kind, corner, way) > most * cau_length(way));
}

// Returns the pair's thickness, or 0 if it is less than `least`. Elements that join the parts are
// searched only if they matter.
static double thickness_of(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4],
                           double least)
{
	double whole = collide->thickness_m;
	cau_vec3 corner[4];
	for (int i = 0; i < 4; i++)
		corner[i] = cau_vec3_of(collide->tissue->rest + 3 * (size_t)vertex[i]);
	if (!is_within(kind, corner, surely * whole / near_share))
		return whole;
	double apart = cau_gap_distance(kind, corner);
	if (near_share * apart >= whole)
		return whole;
	if (lesser(whole, far_share * apart) < least)
		return 0;
	double thickness_m = lesser(whole, share_of(collide, kind, vertex) * apart);
	return thickness_m < least ? 0 : thickness_m;
}
INLINE bool may_touch(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4],
                      cau_collide_found *found)
{
	cau_vec3 corner[4];
	double reach[2] = {0, 0};
	int firsts = cau_gap_first(kind);
	for (int i = 0; i < 4; i++) {
		if (collide->exempt[vertex[i]])
			return false;
		corner[i] = cau_vec3_of(collide->range.anchor + 3 * (size_t)vertex[i]);
		reach[i >= firsts] = greater(reach[i >= firsts], collide->range.reach_m[vertex[i]]);
	}
	double whole = collide->thickness_m, may_move = reach[0] + reach[1];
	if (!is_within(kind, corner, whole + may_move))
		return false;
	double apart = cau_gap_distance(kind, corner);
	if (apart > whole + may_move)
		return false;
	found->thickness_m = thickness_of(collide, kind, vertex, least_thickness * whole);
	if (found->thickness_m <= 0 || apart > found->thickness_m + may_move)
		return false;
	found->stiffness = INFINITY;
	for (int i = 0; i < 4; i++)
		found->stiffness = lesser(found->stiffness, collide->stiffness[vertex[i]]);
	return true;
}

bool cau_collide_may_touch(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4],
                           cau_collide_found *found)
{
	return kind == CAU_GAP_VERTEX_FACE ? may_touch(collide, CAU_GAP_VERTEX_FACE, vertex, found)
	                                   : may_touch(collide, CAU_GAP_EDGE_EDGE, vertex, found);
}

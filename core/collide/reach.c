// SPDX-License-Identifier: GPL-3.0-or-later
// Positions for which the pairs are known: each vertex within its reach of its anchor. A vertex
// that has left its reach gets a new anchor. So does each vertex that has used up a part of its
// reach. Pairs of these vertices are searched again (find.c).
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "collide/collide.h"

// Distance that a pushed vertex may always move, as a share of the thickness.
static const double least_room = 0.4;
// Distance that a pushed vertex may move, as a share of its step.
static const double room_of_step = 1.5;
// Extra reach for the steps of an iteration, as a share of the thickness.
static const double room_of_tick = 0.1;
static const double ahead = 0.3;   // extra reach for later ticks, as a share of the thickness
static const double used_up = 0.6; // share of the reach; vertices beyond get new anchors
enum { TRIES = 12 };

double cau_collide_most_room(const cau_collide *collide, double step_m)
{
	double room = room_of_step * step_m, least = least_room * collide->thickness_m;
	return room > least ? room : least;
}

double cau_collide_most_step(const cau_collide *collide)
{
	return collide->thickness_m > cau_collide_most_step_m ? collide->thickness_m
	                                                      : cau_collide_most_step_m;
}

// Returns a vertex's step, shortened to the longest allowed step.
static cau_vec3 step_of(const cau_collide *collide, int32_t vertex)
{
	cau_vec3 step = cau_vec3_of(collide->step + 3 * (size_t)vertex);
	double way = cau_length(step), most = cau_collide_most_step(collide);
	return way < most ? step : cau_scale(most / way, step);
}

double cau_collide_room(const cau_collide *collide, int32_t vertex)
{
	return cau_collide_most_room(collide, cau_length(step_of(collide, vertex)));
}

// Positions for which a vertex's pairs must be known: those within `reach_m` of `middle`. For a
// step this is the ball around its line. A pushed vertex may move in any direction.
typedef struct ball {
	cau_vec3 middle;
	double reach_m;
} ball;

static ball needed(const cau_collide *collide, const double *x, cau_collide_need need, int32_t v)
{
	cau_vec3 at = cau_vec3_of(x + 3 * (size_t)v);
	if (need == CAU_COLLIDE_PLACE)
		return (ball){at, 0};
	double besides = need == CAU_COLLIDE_TICK ? room_of_tick * collide->thickness_m : 0;
	if (collide->filter.pushed[v])
		return (ball){at, besides + cau_collide_room(collide, v)};
	cau_vec3 half = cau_scale(0.5, step_of(collide, v));
	return (ball){cau_add(at, half), besides + cau_length(half)};
}

// Whether all positions that are needed of a vertex are within a share of its reach.
static bool is_enough(const cau_collide *collide, const double *x, cau_collide_need need, int32_t v,
                      double share)
{
	if (collide->exempt[v])
		return true;
	ball b = needed(collide, x, need, v);
	cau_vec3 away = cau_sub(b.middle, cau_vec3_of(collide->range.anchor + 3 * (size_t)v));
	double left = share * (collide->range.reach_m[v] - b.reach_m);
	return left >= 0 && cau_dot(away, away) <= left * left;
}

static void anchor(cau_collide *collide, int32_t v, cau_vec3 middle, double reach_m)
{
	const double rounding = 1 + 1e-5; // all needed positions are within reach despite rounding
	cau_vec3_to(middle, collide->range.anchor + 3 * (size_t)v);
	collide->range.reach_m[v] = rounding * reach_m;
	collide->surface.changed[v] = 1;
}

static void look_at_all(cau_collide *collide)
{
	memset(collide->surface.changed, 1, (size_t)collide->tissue->vertex_count);
}

static void anchor_used_up(cau_collide *collide, const double *x, cau_collide_need need)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	double besides = ahead * collide->thickness_m;
	for (int32_t k = 0; k < vertices->count; k++) {
		int32_t v = vertices->item[k];
		if (collide->range.found && is_enough(collide, x, need, v, used_up))
			continue;
		ball b = needed(collide, x, need, v);
		anchor(collide, v, b.middle, b.reach_m + besides);
	}
}

// Searches only the pairs that the step needs, or with a share of that reach. A search with a
// longer reach would find all of these pairs too. So a search with a longer reach cannot succeed
// where this search fails.
static bool search_least(cau_collide *collide, cau_pool *pool, const double *x,
                         cau_collide_need need, double share)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	if (need == CAU_COLLIDE_TICK)
		need = CAU_COLLIDE_STEP;
	for (int32_t k = 0; k < vertices->count; k++) {
		int32_t v = vertices->item[k];
		ball b = needed(collide, x, need, v);
		if (share < 1) { // no step leads farther from x in this case (filter.c)
			double way = collide->filter.pushed[v] ? b.reach_m : cau_length(step_of(collide, v));
			b = (ball){cau_vec3_of(x + 3 * (size_t)v), share * way};
		}
		anchor(collide, v, b.middle, b.reach_m);
	}
	look_at_all(collide);
	return cau_collide_search(collide, pool);
}

void cau_collide_find(cau_collide *collide, cau_pool *pool, const double *x, cau_collide_need need)
{
	CAU_ASSERT(collide->surface.listed, "%d faces drawn", collide->surface.faces.count);
	collide->search_count++;
	anchor_used_up(collide, x, need);
	if (!collide->range.found)
		look_at_all(collide);
	collide->range.found = true;
	double share = 1;
	if (cau_collide_search(collide, pool) || search_least(collide, pool, x, need, share))
		return;
	collide->cut_short_count++;
	for (int tries = 0; tries < TRIES && need != CAU_COLLIDE_PLACE; tries++)
		if (search_least(collide, pool, x, need, share /= 2))
			return;
	// if false, even the touching pairs exceed the capacity
	collide->range.found = search_least(collide, pool, x, need, 0);
}

bool cau_collide_covers(const cau_collide *collide, const double *x, cau_collide_need need)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	if (!collide->range.found)
		return false;
	for (int32_t k = 0; k < vertices->count; k++)
		if (!is_enough(collide, x, need, vertices->item[k], 1))
			return false;
	return true;
}

bool cau_collide_covers_pushed(const cau_collide *collide, const double *x)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	if (!collide->range.found)
		return false;
	for (int32_t k = 0; k < vertices->count; k++) {
		int32_t v = vertices->item[k];
		if (collide->filter.pushed[v] && !is_enough(collide, x, CAU_COLLIDE_STEP, v, 1))
			return false;
	}
	return true;
}

double cau_collide_slack(const cau_collide *collide, const double *x)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	double least = INFINITY;
	for (int32_t k = 0; k < vertices->count; k++) {
		size_t v = (size_t)vertices->item[k];
		if (collide->exempt[v])
			continue;
		cau_vec3 away = cau_sub(cau_vec3_of(x + 3 * v), cau_vec3_of(collide->range.anchor + 3 * v));
		double left = collide->range.reach_m[v] - sqrt(cau_dot(away, away));
		least = left < least ? left : least;
	}
	return least;
}

// ---- elements that have died

void cau_collide_forget_dead(cau_collide *collide)
{
	const cau_primitives *all = &collide->tissue->primitives;
	const int32_t count[] = {all->triangle_count, all->tetrahedron_count, all->link_count};
	const int32_t *vertex[] = {all->triangle, all->tetrahedron, all->link}, corners[] = {3, 4, 2};
	for (int kind = 0; kind < CAU_PRIMITIVE_KINDS; kind++) {
		const uint8_t *alive = collide->alive[kind];
		uint8_t *before = collide->search.alive_before[kind];
		if (!alive || memcmp(alive, before, (size_t)count[kind]) == 0)
			continue;
		for (int32_t i = 0; i < count[kind]; i++)
			for (int32_t k = 0; k < corners[kind] && alive[i] != before[i]; k++)
				collide->surface
					.changed[vertex[kind][(size_t)i * (size_t)corners[kind] + (size_t)k]] = 1;
		memcpy(before, alive, (size_t)count[kind]);
	}
}

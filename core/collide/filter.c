// SPDX-License-Identifier: GPL-3.0-or-later
// Steps that cross nothing. Corners move straight, so a pair whose parts a direction separates
// before and after a step is separated by it all the way. A pair may lose four fifths of its
// distance in a step: what wants more is first moved back, both parts by what they weigh, and then,
// where many pairs want different things, shortened to less than half of the distance, corner by
// corner, which no partner's move can undo [divide and truncate, after Chen et al. 2025].
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "collide/collide.h"

static const double kept_share = 0.2;    // of its distance, or of the thickness if that is less;
static const double kept_by_guess = 1;   // by the first guess, which adds no energy so
static const double least_share = 0.005; // of the thickness: a pair that is so near comes no nearer
enum { PASSES = 8 };

typedef struct look {
	cau_vec3 corner[4], step[4], after[4];
	cau_vec3 normal;
	double distance, floor; // before; after the step it may be no less
} look;

static void see(const cau_collide *collide, const cau_collide_pair *pair, const double *x, look *l)
{
	for (int i = 0; i < 4; i++) {
		size_t at = 3 * (size_t)pair->vertex[i];
		l->corner[i] = cau_vec3_of(x + at);
		l->step[i] = cau_vec3_of(collide->step + at);
		l->after[i] = cau_add(l->corner[i], l->step[i]);
	}
}

// How much the pair may lose of its distance at most, whichever way it lies.
static double most_closing(const cau_collide_pair *pair, const look *l)
{
	int firsts = cau_gap_first(pair->kind);
	double most2 = 0;
	for (int i = 0; i < firsts; i++)
		for (int j = firsts; j < 4; j++) {
			cau_vec3 way = cau_sub(l->step[i], l->step[j]);
			most2 = fmax(most2, cau_dot(way, way));
		}
	return sqrt(most2);
}

// Whether the pair comes too near on the way; then the plane between its parts is measured.
static bool comes_near(const cau_collide *collide, cau_collide_pair *pair, const double *x, look *l)
{
	see(collide, pair, x, l);
	double clear = collide->kept_share * pair->thickness_m;
	if (cau_gap_along(pair->kind, l->corner, pair->plane) - most_closing(pair, l) >= clear)
		return false;
	cau_gap gap = cau_gap_between(pair->kind, l->corner);
	if (!(gap.distance > 0)) // crossed before: nothing tells the sides
		return false;
	pair->plane = l->normal = gap.normal;
	l->distance = gap.distance;
	l->floor = fmax(collide->kept_share * fmin(gap.distance, pair->thickness_m),
	                fmin(least_share * pair->thickness_m, gap.distance));
	// what is told of the same numbers twice may differ by rounding
	return cau_gap_along(pair->kind, l->after, gap.normal) < l->floor - 1e-9 * l->distance;
}

static double mobility(const cau_collide *collide, const cau_collide_pair *pair, int first,
                       int last)
{
	double mass = 0;
	int free = 0;
	for (int i = first; i < last; i++)
		if (!collide->fixed[pair->vertex[i]]) {
			mass += collide->tissue->mass[pair->vertex[i]];
			free++;
		}
	return free ? free / mass : 0;
}

static void move_corner(cau_collide *collide, int32_t vertex, double by, cau_vec3 normal)
{
	double *step = collide->step + 3 * (size_t)vertex;
	if (collide->fixed[vertex])
		return;
	cau_vec3_to(cau_add_scaled(cau_vec3_of(step), by, normal), step);
}

// Moves both parts back along the plane's normal until they keep their distance.
static void part(cau_collide *collide, const cau_collide_pair *pair, const look *l)
{
	int firsts = cau_gap_first(pair->kind);
	double along[4], a = mobility(collide, pair, 0, firsts), b = mobility(collide, pair, firsts, 4);
	double least = INFINITY, most = -INFINITY;
	if (!(a + b > 0))
		return;
	for (int i = 0; i < 4; i++) {
		along[i] = cau_dot(l->after[i], l->normal);
		if (i < firsts)
			least = fmin(least, along[i]);
		else
			most = fmax(most, along[i]);
	}
	double wanting = l->floor - (least - most);
	least += wanting * a / (a + b);
	most -= wanting * b / (a + b);
	for (int i = 0; i < 4; i++) {
		double by = i < firsts ? fmax(least - along[i], 0) : fmin(most - along[i], 0);
		if (by != 0)
			move_corner(collide, pair->vertex[i], by, l->normal);
	}
}

// ---- what always holds

static bool shorten(cau_collide *collide, int32_t vertex, double most)
{
	double *step = collide->step + 3 * (size_t)vertex;
	double length = cau_length(cau_vec3_of(step));
	if (collide->fixed[vertex] || length <= most)
		return false;
	cau_vec3_to(cau_scale(most / length, cau_vec3_of(step)), step);
	return true;
}

// Corners go no further than half of what their pair may lose: that stays enough, whatever other
// pairs shorten.
static void stop(cau_collide *collide, const cau_collide_pair *pair, const look *l)
{
	double most = fmax((l->distance - l->floor) / 2, 0);
	for (int i = 0; i < 4; i++)
		shorten(collide, pair->vertex[i], most);
}

static void stop_pairs(cau_collide *collide, const double *x)
{
	look l;
	bool again = true;
	memset(collide->stopped, 0, (size_t)collide->pair_count * sizeof *collide->stopped);
	while (again) { // each pair is stopped once at most
		again = false;
		for (int32_t i = 0; i < collide->pair_count; i++) {
			if (collide->stopped[i] || !comes_near(collide, &collide->pair[i], x, &l))
				continue;
			stop(collide, &collide->pair[i], &l);
			collide->stopped[i] = again = true;
		}
	}
}

// Steps end within the reach for which the pairs are known.
static bool stay_in_reach(cau_collide *collide, const double *x)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	bool shortened = false;
	for (int32_t k = 0; k < vertices->count; k++) {
		size_t v = (size_t)vertices->item[k];
		cau_vec3 from = cau_sub(cau_vec3_of(x + 3 * v), cau_vec3_of(collide->anchor + 3 * v));
		cau_vec3 step = cau_vec3_of(collide->step + 3 * v), to = cau_add(from, step);
		double reach = collide->reach_m[v];
		if (collide->fixed[v] || cau_dot(to, to) <= reach * reach)
			continue;
		double left = fmax(reach - cau_length(from), 0) * (1 - 1e-9);
		shortened |= shorten(collide, (int32_t)v, left);
	}
	return shortened;
}

static bool ends_in_reach(const cau_collide *collide, const double *x)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	if (!collide->found)
		return false;
	for (int32_t k = 0; k < vertices->count; k++) {
		size_t v = (size_t)vertices->item[k];
		double away2 = 0, reach = collide->reach_m[v];
		for (size_t i = 3 * v; i < 3 * v + 3; i++) {
			double away = x[i] + collide->step[i] - collide->anchor[i];
			away2 += away * away;
		}
		if (!(away2 <= reach * reach))
			return false;
	}
	return true;
}

bool cau_collide_filter(cau_collide *collide, cau_pool *pool, const double *x, bool guess)
{
	look l;
	collide->kept_share = guess ? kept_by_guess : kept_share;
	bool changed = false, again = true;
	if (!ends_in_reach(collide, x)) {
		cau_collide_find(collide, pool, x, collide->step);
		changed = stay_in_reach(collide, x);
	}
	collide->out_of_reach = changed;
	for (int pass = 0; pass < PASSES && again; pass++) {
		again = false;
		for (int32_t i = 0; i < collide->pair_count; i++)
			if (comes_near(collide, &collide->pair[i], x, &l)) {
				part(collide, &collide->pair[i], &l);
				again = changed = true;
			}
	}
	if (changed) {
		stay_in_reach(collide, x);
		stop_pairs(collide, x);
	}
	collide->held_back = changed;
	collide->held_back_count += changed && !guess;
	return changed;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Filters steps so that no tissue crosses tissue. Corners move along straight lines. So a direction
// that separates the parts of a pair before and after a step separates them during the whole step.
// A pair may lose at most four fifths of its distance in a step. If a step takes more, both parts
// are first moved back, the lighter part by more. If many pairs conflict, this may not be enough.
// Then the step of each corner is shortened to half of the distance that its pair may lose. No
// motion of the other part can undo that [divide and truncate, after Chen et al. 2025].
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "collide/collide.h"

// Share that a pair keeps in a step: of its distance, or of its thickness if the thickness is less.
static const double kept_share = 0.2;
// The same share for the first guess. With 1, no pair comes nearer than its thickness, so the guess
// adds no contact energy.
static const double kept_by_guess = 1;
// Distance, as a share of the thickness, below which a pair comes no nearer.
static const double least_share = 0.005;
// Share of a reach that a step may use. Rounding then leads no vertex beyond the reach.
static const double just = 1 - 1e-6;
enum { PASSES = 8 };

typedef struct look {
	cau_vec3 corner[4], step[4], after[4];
	cau_vec3 normal;
	double distance, floor; // distance before the step; least distance allowed after it
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

// Returns the most that the step can take from the pair's distance, in any direction.
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

// Whether the pair comes too near during the step. Measures the plane between its parts unless the
// known plane suffices.
static bool comes_near(const cau_collide *collide, cau_collide_pair *pair, const double *x, look *l)
{
	see(collide, pair, x, l);
	double clear = collide->filter.kept_share * pair->thickness_m;
	if (cau_collide_is_exempt(collide, pair))
		return false;
	if (cau_gap_along(pair->kind, l->corner, pair->plane) - most_closing(pair, l) >= clear)
		return false;
	cau_gap gap = cau_gap_between(pair->kind, l->corner);
	if (!(gap.distance > 0)) // the parts crossed before, so no plane separates them
		return false;
	pair->plane = l->normal = gap.normal;
	l->distance = gap.distance;
	l->floor = fmax(collide->filter.kept_share * fmin(gap.distance, pair->thickness_m),
	                fmin(least_share * pair->thickness_m, gap.distance));
	// the margin covers rounding, by which two evaluations of one distance may differ
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

static bool shorten(cau_collide *collide, int32_t vertex, double most)
{
	double *step = collide->step + 3 * (size_t)vertex;
	double length2 = cau_dot(cau_vec3_of(step), cau_vec3_of(step));
	if (length2 <= most * most || collide->fixed[vertex] || collide->exempt[vertex])
		return false;
	cau_vec3_to(cau_scale(most / sqrt(length2), cau_vec3_of(step)), step);
	return true;
}

// Moves a corner that is marked as pushed. Any other corner is only marked, and the filter repeats
// with it.
static void move_corner(cau_collide *collide, int32_t vertex, double by, cau_vec3 normal)
{
	double *step = collide->step + 3 * (size_t)vertex;
	if (collide->fixed[vertex])
		return;
	if (!collide->filter.pushed[vertex]) {
		collide->filter.pushed[vertex] = 1;
		collide->filter.pushes_more = true;
		return;
	}
	cau_vec3_to(cau_add_scaled(cau_vec3_of(step), by, normal), step);
	shorten(collide, vertex, collide->filter.room_m[vertex]);
}

// Moves both parts back along the plane's normal until they keep their distance. A corner moves at
// most by its room_m, because pairs beyond that are not known.
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

// ---- shortening, which alone prevents every crossing

// Shortens the steps of a pair's corners to half of the distance that the pair may lose. The pair
// then cannot cross, however much other pairs shorten the steps.
static void stop(cau_collide *collide, const cau_collide_pair *pair, const look *l)
{
	double most = fmax((l->distance - l->floor) / 2, 0);
	for (int i = 0; i < 4; i++)
		shorten(collide, pair->vertex[i], most);
}

// Whether a pair keeps its distance for all motions of its corners within away_m.
static bool is_clear(const cau_collide *collide, int32_t pair)
{
	return cau_collide_is_far(collide, pair, collide->seen.away_m,
	                          collide->filter.kept_share * collide->pair[pair].thickness_m);
}

static void stop_pairs(cau_collide *collide, const double *x)
{
	look l;
	bool again = true;
	memset(collide->filter.stopped, 0,
	       (size_t)collide->pair_count * sizeof *collide->filter.stopped);
	while (again) { // each pair is stopped once at most
		again = false;
		for (int32_t i = 0; i < collide->pair_count; i++) {
			if (collide->filter.stopped[i] || is_clear(collide, i) ||
			    !comes_near(collide, &collide->pair[i], x, &l))
				continue;
			stop(collide, &collide->pair[i], &l);
			collide->filter.stopped[i] = again = true;
		}
	}
}

// Shortens each step to the longest allowed step or, if `by_reach`, to its vertex's reach. Returns
// whether a step was shortened. *longest is the longest step afterwards.
static bool limit(cau_collide *collide, bool by_reach, double *longest)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	double most = cau_collide_most_step(collide), longest2 = 0;
	bool shortened = false;
	for (int32_t k = 0; k < vertices->count; k++) {
		int32_t v = vertices->item[k];
		if (collide->exempt[v])
			continue;
		shortened |= shorten(collide, v, by_reach ? just * collide->range.reach_m[v] : most);
		cau_vec3 step = cau_vec3_of(collide->step + 3 * (size_t)v);
		longest2 = cau_dot(step, step) > longest2 ? cau_dot(step, step) : longest2;
	}
	*longest = sqrt(longest2);
	return shortened;
}

// Finds the pairs for the step. Returns whether steps had to be shortened because the pairs exceed
// the capacity.
static bool find(cau_collide *collide, cau_pool *pool, const double *x)
{
	int32_t before = collide->cut_short_count;
	double longest;
	cau_collide_find(collide, pool, x, CAU_COLLIDE_STEP);
	cau_collide_see(collide, pool, x);
	return collide->cut_short_count > before && limit(collide, true, &longest);
}

// Sets room_m of the pushed corners. If the pairs exceed the capacity, the reach is the limit.
static void take_room(cau_collide *collide)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	for (int32_t k = 0; k < vertices->count; k++) {
		int32_t v = vertices->item[k];
		if (collide->filter.pushed[v])
			collide->filter.room_m[v] =
				fmin(cau_collide_room(collide, v), just * collide->range.reach_m[v]);
	}
}

// Moves back pairs that come too near. Afterwards each step may be as long as its vertex's room_m.
static void part_pairs(cau_collide *collide, const double *x)
{
	look l;
	bool again = true;
	take_room(collide);
	collide->filter.pushes_more = false;
	for (int pass = 0; pass < PASSES && again && !collide->filter.pushes_more; pass++) {
		again = false;
		for (int32_t i = 0; i < collide->pair_count; i++) {
			if (is_clear(collide, i) || !comes_near(collide, &collide->pair[i], x, &l))
				continue;
			part(collide, &collide->pair[i], &l);
			again = true;
		}
	}
}

// Marks the corners of pairs that come near as pushed. Returns whether there are any.
static bool note_pushed(cau_collide *collide, const double *x)
{
	look l;
	bool any = false;
	for (int32_t i = 0; i < collide->pair_count; i++) {
		const int32_t *vertex = collide->pair[i].vertex;
		if (is_clear(collide, i) || !comes_near(collide, &collide->pair[i], x, &l))
			continue;
		for (int k = 0; k < 4; k++)
			collide->filter.pushed[vertex[k]] = 1;
		any = true;
	}
	return any;
}

// Moves back pairs that come too near. A pushed corner may move farther than it wanted, so pairs
// must be known for that motion. If further corners turn out to be pushed, the function starts
// again from the wanted step. Returns whether steps had to be shortened because the pairs exceed
// the capacity.
static bool part_known_pairs(cau_collide *collide, cau_pool *pool, const double *x, double longest)
{
	size_t n = (size_t)collide->tissue->vertex_count, bytes = 3 * n * sizeof(double);
	double away = collide->seen.away_m;
	bool shortened = false;
	do {
		collide->seen.away_m = away;
		if (!cau_collide_covers_pushed(collide, x))
			shortened |= find(collide, pool, x);
		away = collide->seen.away_m;
		collide->seen.away_m += cau_collide_most_room(collide, longest);
		memcpy(collide->filter.wanted, collide->step, bytes);
		part_pairs(collide, x);
		if (collide->filter.pushes_more)
			memcpy(collide->step, collide->filter.wanted, bytes);
	} while (collide->filter.pushes_more);
	memset(collide->filter.pushed, 0, n);
	return shortened;
}

// Whether any step of at most `longest` from the present positions stays where pairs are known.
static bool is_within(const cau_collide *collide, double longest)
{
	return collide->range.found && collide->seen.slack_m - collide->seen.away_m >= longest;
}

// Ends a filter. The positions after the step may be rounded to single precision.
static void end(cau_collide *collide, bool changed)
{
	const double rounding = 1 + 1e-6;
	collide->seen.away_m *= rounding;
	collide->range.ahead = true;
	collide->filter.held_back = changed;
}

bool cau_collide_foresee(cau_collide *collide, double longest)
{
	collide->filter.kept_share = kept_share;
	collide->filter.unclear_count = 0;
	if (longest > cau_collide_most_step(collide) || !is_within(collide, longest))
		return false;
	for (int32_t i = 0; i < collide->pair_count; i++)
		if (!cau_collide_is_far(collide, i, collide->seen.away_m + longest,
		                        kept_share * collide->pair[i].thickness_m))
			collide->filter.unclear[collide->filter.unclear_count++] = i;
	return true;
}

bool cau_collide_lets_pass(cau_collide *collide, const double *x, double longest)
{
	look l;
	for (int32_t k = 0; k < collide->filter.unclear_count; k++)
		if (comes_near(collide, &collide->pair[collide->filter.unclear[k]], x, &l))
			return false;
	collide->seen.away_m += longest;
	end(collide, false);
	return true;
}

bool cau_collide_filter(cau_collide *collide, cau_pool *pool, const double *x, bool guess)
{
	double longest;
	collide->filter.kept_share = guess ? kept_by_guess : kept_share;
	CAU_ASSERT(cau_collide_away(collide, x) <= collide->seen.away_m + 1e-9 * collide->thickness_m,
	           "somebody is farther than %g m from where the tick began", collide->seen.away_m);
	bool changed = limit(collide, false, &longest);
	if (!is_within(collide, longest) && !cau_collide_covers(collide, x, CAU_COLLIDE_STEP))
		changed |= find(collide, pool, x);
	collide->filter.out_of_reach = changed;
	collide->seen.away_m += longest;
	if (note_pushed(collide, x)) {
		collide->seen.away_m -= longest;
		collide->filter.out_of_reach |= part_known_pairs(collide, pool, x, longest);
		changed = true;
	}
	if (changed)
		stop_pairs(collide, x);
	end(collide, changed);
	collide->held_back_count += changed && !guess;
	return changed;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Energy of touching pairs, a part of eq. 4, and its gradient. Pairs are measured in parallel, in
// shares of SHARE pairs. Energies and forces are added in the order of the pairs.
#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "cautery/assert.h"
#include "collide/collide.h"

static const double soft_share = 0.002; // share of the thickness below which force grows linearly
enum { SHARE = 256 };                   // pairs in one share of the work

static double potential(double stiffness, double thickness, double distance, double *slope,
                        double *curvature)
{
	double half = thickness / 2, soft = soft_share * thickness;
	CAU_ASSERT(thickness > 0 && stiffness > 0, "%g N/m over %g m", stiffness, thickness);
	if (distance >= half) {
		double in = fmax(thickness - distance, 0);
		*slope = -stiffness * in;
		*curvature = stiffness;
		return stiffness * in * in / 2;
	}
	double scale = stiffness * half * half, at = fmax(distance, soft), in = at - distance;
	double force = scale / at;
	*curvature = force / at;
	*slope = -force - *curvature * in;
	return scale * (0.5 + log(half / at)) + force * in + *curvature * in * in / 2;
}

// Factor on the thickness. If a known direction separates the parts by more than the product, the
// nearest points are not searched. The factor exceeds all rounding, so a search would give the same
// result.
static const double surely = 1 + 1e-9;

double cau_collide_press(const cau_collide *collide, int32_t pair, const double *x, cau_gap *gap,
                         double *slope, double *curvature)
{
	const cau_collide_pair *of = &collide->pair[pair];
	cau_vec3 corner[4];
	cau_collide_corners(of, x, corner);
	*slope = *curvature = 0;
	if (cau_gap_along(of->kind, corner, of->plane) >= surely * of->thickness_m)
		return 0;
	*gap = cau_gap_between(of->kind, corner);
	if (!(gap->distance < of->thickness_m) || !(gap->distance > 0))
		return 0;
	return potential(of->stiffness, of->thickness_m, gap->distance, slope, curvature);
}

typedef struct measuring {
	cau_collide *collide;
	const double *x;
} measuring;

static void measure(const cau_collide *collide, int32_t index, const double *x)
{
	cau_vec3 corner[4];
	cau_collide_pair *pair = &collide->pair[index];
	pair->slope = 0;
	if (cau_collide_is_far(collide, index, collide->seen.away_m, surely * pair->thickness_m))
		return;
	cau_collide_corners(pair, x, corner);
	if (cau_gap_along(pair->kind, corner, pair->plane) >= surely * pair->thickness_m ||
	    cau_collide_is_exempt(collide, pair))
		return;
	cau_gap gap = cau_gap_between(pair->kind, corner);
	pair->plane = gap.normal;
	if (!(gap.distance < pair->thickness_m) || !(gap.distance > 0))
		return;
	potential(pair->stiffness, pair->thickness_m, gap.distance, &pair->slope, &pair->curvature);
	pair->normal = gap.normal;
	memcpy(pair->weight, gap.weight, sizeof pair->weight);
}

static int32_t share_count(const cau_collide *collide)
{
	return (collide->pair_count + SHARE - 1) / SHARE;
}

// Returns the index after the last pair of a share.
static int32_t end_of(const cau_collide *collide, int32_t share)
{
	CAU_ASSERT_INDEX(share, share_count(collide));
	int32_t end = (share + 1) * SHARE;
	return end < collide->pair_count ? end : collide->pair_count;
}

static void measure_part(void *context, int32_t share)
{
	const measuring *work = context;
	cau_collide *collide = work->collide;
	int32_t end = end_of(collide, share);
	for (int32_t i = share * SHARE; i < end; i++)
		measure(collide, i, work->x);
}

static void load(cau_collide *collide, const int32_t vertex[4], const double weight[4],
                 cau_vec3 force)
{
	for (int i = 0; i < 4; i++) {
		double *to = collide->load.gradient + 3 * (size_t)vertex[i];
		if (weight[i] == 0)
			continue;
		if (!collide->load.is_loaded[vertex[i]])
			collide->load.vertex[collide->load.count++] = vertex[i];
		collide->load.is_loaded[vertex[i]] = 1;
		to[0] += weight[i] * force.x;
		to[1] += weight[i] * force.y;
		to[2] += weight[i] * force.z;
	}
}

static void unload(cau_collide *collide)
{
	for (int32_t k = 0; k < collide->load.count; k++) {
		memset(collide->load.gradient + 3 * (size_t)collide->load.vertex[k], 0, 3 * sizeof(double));
		collide->load.is_loaded[collide->load.vertex[k]] = 0;
	}
	collide->load.count = 0;
}

// Computes the energy of friction. The friction is elastic up to the largest friction force, and
// beyond has this constant force. The force is `present` times the slip.
double cau_collide_slip(const cau_collide *collide, const cau_collide_grip *grip, const double *x,
                        cau_vec3 *slip, double *present)
{
	*slip = (cau_vec3){0, 0, 0};
	for (int i = 0; i < 4; i++) {
		size_t at = 3 * (size_t)grip->vertex[i];
		*slip = cau_add_scaled(*slip, grip->weight[i],
		                       cau_sub(cau_vec3_of(x + at), cau_vec3_of(collide->start + at)));
	}
	*slip = cau_add_scaled(*slip, -cau_dot(*slip, grip->normal), grip->normal);
	double length = cau_length(*slip), yield = grip->most_n / grip->stiffness;
	*present = grip->stiffness;
	if (!(length > 0))
		return 0;
	double force = length < yield ? grip->stiffness * length : grip->most_n;
	*present = force / length;
	return length < yield ? force * length / 2 : force * (length - yield / 2);
}

static double add_grip(cau_collide *collide, cau_collide_grip *grip, const double *x)
{
	cau_vec3 slip;
	double energy = cau_collide_slip(collide, grip, x, &slip, &grip->present);
	if (energy > 0)
		load(collide, grip->vertex, grip->weight, cau_scale(grip->present, slip));
	return energy;
}

static double distance_of(const cau_collide_pair *pair, const double *x)
{
	cau_vec3 way = {0, 0, 0};
	for (int i = 0; i < 4; i++)
		way = cau_add_scaled(way, pair->weight[i], cau_vec3_of(x + 3 * (size_t)pair->vertex[i]));
	return cau_length(way);
}

// Adds the energy and forces of all pairs, in the pairs' order.
static void add_pairs(cau_collide *collide, const double *x)
{
	collide->result.energy_j = 0;
	collide->result.touching_count = 0;
	collide->result.steepest = 0;
	collide->result.touching_hash = CAU_HASH_START;
	for (int32_t i = 0; i < collide->pair_count; i++) {
		const cau_collide_pair *pair = &collide->pair[i];
		double slope, curvature;
		if (pair->slope == 0)
			continue;
		double distance = distance_of(pair, x);
		collide->result.energy_j +=
			potential(pair->stiffness, pair->thickness_m, distance, &slope, &curvature);
		collide->result.touching_count++;
		collide->result.steepest =
			fmax(collide->result.steepest, pair->curvature / pair->stiffness);
		if (distance < pair->thickness_m / 2)
			collide->result.touching_hash =
				cau_hash_bytes(collide->result.touching_hash, pair->vertex, sizeof pair->vertex);
		load(collide, pair->vertex, pair->weight, cau_scale(pair->slope, pair->normal));
	}
}

// ---- distances of pairs at the tick's start, which spare most pairs a later measurement

static void see_part(void *context, int32_t share)
{
	const measuring *work = context;
	cau_collide *collide = work->collide;
	int32_t end = end_of(collide, share);
	for (int32_t i = share * SHARE; i < end; i++) {
		cau_collide_pair *pair = &collide->pair[i];
		cau_vec3 corner[4];
		cau_collide_corners(pair, work->x, corner);
		collide->seen.apart_m[i] = cau_gap_along(pair->kind, corner, pair->plane);
		if (collide->seen.apart_m[i] > 2 * pair->thickness_m)
			continue;
		cau_gap gap = cau_gap_between(pair->kind, corner);
		collide->seen.apart_m[i] = gap.distance;
		pair->plane = gap.normal;
	}
}

void cau_collide_see(cau_collide *collide, cau_pool *pool, const double *x)
{
	measuring work = {collide, x};
	memcpy(collide->seen.at, x, 3 * (size_t)collide->tissue->vertex_count * sizeof *x);
	collide->seen.away_m = 0;
	collide->seen.slack_m = cau_collide_slack(collide, x);
	cau_pool_run(pool, share_count(collide), see_part, &work);
}

double cau_collide_away(const cau_collide *collide, const double *x)
{
	const cau_surface_parts *vertices = &collide->surface.vertices;
	double most2 = 0;
	for (int32_t k = 0; k < vertices->count; k++) {
		size_t at = 3 * (size_t)vertices->item[k];
		if (collide->exempt[vertices->item[k]])
			continue;
		cau_vec3 way = cau_sub(cau_vec3_of(x + at), cau_vec3_of(collide->seen.at + at));
		double way2 = cau_dot(way, way);
		most2 = way2 > most2 ? way2 : most2;
	}
	return sqrt(most2);
}

void cau_collide_stand(cau_collide *collide, const double *x)
{
	collide->seen.away_m = cau_collide_away(collide, x);
}

double cau_collide_evaluate(cau_collide *collide, cau_pool *pool, const double *x)
{
	bool ahead = collide->range.ahead;
	collide->range.ahead = false;
	CAU_ASSERT(!ahead || cau_collide_covers(collide, x, CAU_COLLIDE_PLACE),
	           "%d pairs are not those of x", collide->pair_count);
	if (!ahead && !cau_collide_covers(collide, x, CAU_COLLIDE_PLACE)) {
		cau_collide_find(collide, pool, x, CAU_COLLIDE_PLACE);
		cau_collide_see(collide, pool, x);
	} else if (!ahead) {
		cau_collide_stand(collide, x);
	}
	measuring work = {collide, x};
	cau_pool_run(pool, share_count(collide), measure_part, &work);
	unload(collide);
	add_pairs(collide, x);
	double energy = collide->result.energy_j;
	for (int32_t i = 0; i < collide->grip_count; i++)
		energy += add_grip(collide, &collide->grip[i], x);
	return energy;
}

bool cau_collide_surround(cau_collide *collide, cau_pool *pool, const double *x,
                          const int32_t *vertex, int32_t count, double way_m)
{
	memset(collide->step, 0, 3 * (size_t)collide->tissue->vertex_count * sizeof *collide->step);
	for (int32_t i = 0; i < count; i++) {
		collide->step[3 * (size_t)vertex[i]] = way_m;
		collide->filter.pushed[vertex[i]] = 1;
	}
	bool all = cau_collide_covers(collide, x, CAU_COLLIDE_STEP);
	int32_t cut_short = collide->cut_short_count;
	if (!all) {
		cau_collide_find(collide, pool, x, CAU_COLLIDE_STEP);
		cau_collide_see(collide, pool, x);
		cau_collide_evaluate(collide, pool, x); // cau_collide_apply needs values of the new pairs
		all = cau_collide_covers(collide, x, CAU_COLLIDE_STEP);
		collide->cut_short_count = cut_short; // this search shortened no step
	}
	for (int32_t i = 0; i < count; i++)
		collide->filter.pushed[vertex[i]] = 0;
	return all;
}

// Adds the reaction of one pair or grip to `answer`: `stiffness` times the motion along the normal,
// and `across` times the motion across the normal.
static void apply(cau_collide *collide, const int32_t vertex[4], const double weight[4],
                  cau_vec3 normal, double stiffness, double across)
{
	cau_vec3 way = {0, 0, 0};
	for (int i = 0; i < 4; i++)
		way = cau_add_scaled(way, weight[i],
		                     cau_vec3_of(collide->load.probe + 3 * (size_t)vertex[i]));
	cau_vec3 force = cau_scale(across, way);
	force = cau_add_scaled(force, (stiffness - across) * cau_dot(way, normal), normal);
	for (int i = 0; i < 4; i++) {
		double *to = collide->load.answer + 3 * (size_t)vertex[i];
		cau_vec3_to(cau_add_scaled(cau_vec3_of(to), weight[i], force), to);
	}
}

void cau_collide_apply(cau_collide *collide)
{
	for (int32_t k = 0; k < collide->load.count; k++)
		memset(collide->load.answer + 3 * (size_t)collide->load.vertex[k], 0, 3 * sizeof(double));
	for (int32_t i = 0; i < collide->pair_count; i++) {
		const cau_collide_pair *pair = &collide->pair[i];
		if (pair->slope != 0)
			apply(collide, pair->vertex, pair->weight, pair->normal, pair->curvature, 0);
	}
	for (int32_t i = 0; i < collide->grip_count; i++) {
		const cau_collide_grip *grip = &collide->grip[i];
		apply(collide, grip->vertex, grip->weight, grip->normal, 0, grip->present);
	}
}

// Makes a grip of each pair that presses at the tick's start. The grip resists sliding in this
// tick.
static void take_grips(cau_collide *collide)
{
	collide->grip_count = 0;
	for (int32_t i = 0; i < collide->pair_count && collide->friction > 0; i++) {
		const cau_collide_pair *pair = &collide->pair[i];
		if (pair->slope == 0)
			continue;
		cau_collide_grip *grip = &collide->grip[collide->grip_count++];
		*grip = (cau_collide_grip){.normal = pair->normal,
		                           .most_n = -collide->friction * pair->slope,
		                           .stiffness = pair->stiffness};
		memcpy(grip->vertex, pair->vertex, sizeof grip->vertex);
		memcpy(grip->weight, pair->weight, sizeof grip->weight);
	}
}

static bool has_changed(const cau_collide *collide)
{
	return memchr(collide->surface.changed, 1, (size_t)collide->tissue->vertex_count) != NULL;
}

void cau_collide_begin(cau_collide *collide, cau_pool *pool, const double *x)
{
	collide->held_back_count = collide->search_count = 0;
	collide->filter.held_back = false;
	collide->grip_count = 0;
	cau_collide_forget_dead(collide);
	cau_collide_note_exempt(collide);
	if (has_changed(collide) || !cau_collide_covers(collide, x, CAU_COLLIDE_TICK))
		cau_collide_find(collide, pool, x, CAU_COLLIDE_TICK);
	cau_collide_see(collide, pool, x);
	collide->range.ahead = true;
	collide->start_energy_j = cau_collide_evaluate(collide, pool, x);
	take_grips(collide);
}

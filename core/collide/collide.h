// SPDX-License-Identifier: GPL-3.0-or-later
// Tissue against tissue: the drawn surface keeps a thickness from itself, and never crosses itself.
//
// Pairs are a vertex and a face, or two edges, that share no vertex. A pair that is nearer than its
// thickness h has an energy that is part of eq. 4 (energy.c): with d its distance,
//
//     k/2 (h - d)^2 down to h/2; below, k h^2/8 + k h^2/4 log(h / 2d),
//
// continuous with its slope and curvature [offset geometric contact, Chen et al. 2025]. Below a
// hundredth of h the force grows linearly, so that it is finite where tissue was crossed before.
// Friction opposes the motion since the tick's start, with the force that the pair had then.
//
// No step crosses (filter.c). A plane separates a pair before and after every move. Corners move
// straight, so it separates them all the way. A corner that would pass the plane is moved back to
// its side, and stopped where that is not enough.
//
// Pairs are valid (find.c) for all positions at which no vertex is farther than its `reach_m` from
// its `anchor`, from tick to tick. Positions beyond need another search. Neither the touching pairs
// nor the order in which their forces are added depends on that, so no snapshot contains it.
#pragma once

#include <stdatomic.h>

#include "base/pool.h"
#include "collide/gap.h"
#include "collide/lanes.h"
#include "collide/surface.h"

enum { CAU_COLLIDE_SLICE = 2048 }; // pairs of a kind that a block may have
// The longest filtered step, m, unless the thickness is longer. It limits how far pairs are
// searched.
static const double cau_collide_most_step_m = 1e-3;

typedef struct cau_collide_pair {
	cau_gap_kind kind;
	int32_t vertex[4];  // corners
	double thickness_m; // less than the surface's where the pair is nearer at rest
	double stiffness;   // k, N/m
	cau_vec3 plane;     // unit: a direction that separated the parts when they were last measured
	double slope;       // dE/dd of the last evaluation, N; 0: apart
	double curvature;   // d2E/dd2 of the last evaluation, N/m
	double weight[4];   // of the corners in the gap, of the last evaluation
	cau_vec3 normal;
} cau_collide_pair;

// The friction of a pair that touched at the tick's start.
typedef struct cau_collide_grip {
	int32_t vertex[4];
	double weight[4];
	cau_vec3 normal;
	double most_n;    // friction times the force that presses
	double stiffness; // N/m, until it slides
	double present;   // N/m: force by way of the last evaluation
} cau_collide_grip;

typedef struct cau_collide_box {
	double least[3], most[3];
} cau_collide_box;

typedef struct cau_collide_found { // a pair as find.c lists it
	int32_t first, second;         // vertex and face, or edges, of the tissue
	double thickness_m, stiffness;
} cau_collide_found;

typedef struct cau_collide_slice { // of a block: what it found, and whether that was all
	int32_t count[2];              // by cau_gap_kind
	bool full;
} cau_collide_slice;

// For which motion pairs must be valid: for a position; also for the step from there, with all by
// which pushed corners may be moved beyond it; or, within the capacity, for the steps of a tick
// that begins.
typedef enum cau_collide_need {
	CAU_COLLIDE_PLACE,
	CAU_COLLIDE_STEP,
	CAU_COLLIDE_TICK,
} cau_collide_need;

typedef struct cau_collide {
	const cau_tissue *tissue;
	double thickness_m, friction;
	const uint8_t *fixed; // (n): borrowed; vertices that no step moves
	// (n): vertices excluded from contact in this tick: held by jaws, inverted, diverged. They are
	// in no pair, and no filter moves them.
	uint8_t *exempt;
	// What joins parts while it lives: triangles, tetrahedra, links; borrowed, NULL: all do.
	const uint8_t *alive[CAU_PRIMITIVE_KINDS];
	double *stiffness; // N/m, (n): of a vertex
	double *longest_m; // (n): of its edges at rest
	cau_surface surface;
	// Where the pairs are valid.
	bool found;
	double *anchor;  // m, (n x 3)
	double *reach_m; // (n)
	bool ahead;      // they are where the filter let the last step lead
	double *seen;    // m, (n x 3): where pairs were measured last, and
	double *apart_m; // (most_pairs): how far apart they were there at least
	double slack_m;  // what is left there of every vertex's reach, at least
	double away_m;   // how far any vertex is from there where we are, at most
	int32_t pair_count, most_pairs;
	cau_collide_pair *pair; // (most_pairs)
	int32_t grip_count;
	cau_collide_grip *grip; // (most_pairs)
	const double *start;    // m, (n x 3): where the tick began
	// Of the last evaluation.
	double energy_j;        // of pairs, without friction
	int32_t touching_count; // pairs nearer than their thickness
	double steepest;        // their curvature over their stiffness, at most
	uint64_t touching_hash; // of which are pressed
	int32_t loaded_count;
	uint8_t *is_loaded; // (n)
	int32_t *loaded;    // (n): vertices that have a gradient
	double *gradient;   // N, (n x 3): of those, else 0
	double *probe;      // m, (n x 3): for cau_collide_apply, and
	double *answer;     // N, what comes of it, both where loaded
	// Of the last filter, and of the tick.
	double kept_share;            // filter.c: of its distance, a pair keeps at least
	bool held_back, out_of_reach; // it shortened; because the pairs are known for no further
	int32_t held_back_count, search_count;
	int32_t cut_short_count; // times that pairs exceeded the capacity, so that steps were shortened
	double *step;            // m, (n x 3): for filter
	double start_energy_j;
	// find.c: what is known
	cau_collide_box *face_box, *edge_box, *vertex_box; // of the tissue's, where they are drawn
	cau_collide_box *block_box[3], *fresh_box[3]; // faces, edges, vertices of a block; those fresh
	cau_collide_slice *slice;                     // (blocks)
	cau_collide_found *list[2];                   // by kind, (blocks x CAU_COLLIDE_SLICE)
	uint8_t *alive_before[CAU_PRIMITIVE_KINDS];   // as they were when it was found
	uint8_t *exempt_before; // `exempt` when it was found, or as the last tick ended; all: unknown
	// The parts' boxes side by side, in the order in which blocks list them; each block begins a
	// group. And which of a group are fresh, a bit each, where the block is touched.
	cau_collide_lanes *lane[3];
	uint8_t *fresh_lane[3];
	int32_t *lane_first[3]; // (blocks + 1): the lists' as they were when that was laid out
	// and scratch
	int32_t touched_count, *touched;              // blocks with a fresh part
	cau_collide_lanes *block_lane, *touched_lane; // all faces of blocks; fresh ones of `touched`
	uint8_t *is_touched;                          // (blocks)
	cau_collide_box *place_box;                   // (blocks): crossed.c, of a block where it is
	bool may_give_up;                             // the result of a failed search is not used
	atomic_bool fails;                            // and it surely does
	atomic_int listed_count;                      // pairs of the blocks that are done
	// filter.c: scratch
	bool *stopped;   // (most_pairs)
	double *wanted;  // m, (n x 3): the step before it was changed
	double *room_m;  // (n): where pushed
	uint8_t *pushed; // (n): corners of pairs that came near; none but while a step is filtered
	bool pushes_more;
	int32_t unclear_count, *unclear; // (most_pairs)
} cau_collide;

// The caller sets `fixed` and `start`, for good.
cau_status cau_collide_create(cau_collide *collide, const cau_tissue *tissue, double thickness_m,
                              double friction, double step_s, cau_arena *arena, cau_error *error);

// Length of the longest filtered step, m.
double cau_collide_most_step(const cau_collide *collide);

// Begins a tick at positions x (m, n x 3). Before it the caller has listed the drawn surface,
// filled `exempt`, and set `cut_short_count` to 1 if an exclusion is to be reported, else 0.
// Searches pairs for steps as long as `collide->step`. Measures the energy at x and takes the
// grips.
void cau_collide_begin(cau_collide *collide, cau_pool *pool, const double *x);

// Energy at x, J, friction's included; the gradient is kept.
double cau_collide_evaluate(cau_collide *collide, cau_pool *pool, const double *x);

// Finds the pairs for x (m, n x 3) and for any motion of `count` vertices by at most way_m. False:
// they exceed the capacity. Not while a step is filtered.
bool cau_collide_surround(cau_collide *collide, cau_pool *pool, const double *x,
                          const int32_t *vertex, int32_t count, double way_m);

// Energy of one pair at x, J, its slope (N) and its curvature (N/m). All are 0 where the pair is
// apart; then *gap may be left as it is.
double cau_collide_press(const cau_collide *collide, int32_t pair, const double *x, cau_gap *gap,
                         double *slope, double *curvature);
// Energy of one grip at x, J. Its force is -*present (N/m) times *slip (m).
double cau_collide_slip(const cau_collide *collide, const cau_collide_grip *grip, const double *x,
                        cau_vec3 *slip, double *present);

// answer = K probe over the loaded vertices. K is the Hessian of the energy of the last evaluation,
// without its negative part.
void cau_collide_apply(cau_collide *collide);

// Call before a tick begins in which an excluded vertex takes part in contact again. Excludes also
// the vertices that cross at x.
void cau_collide_exempt_crossed(cau_collide *collide, const double *x);
bool cau_collide_touches_again(const cau_collide *collide);
// Marks the crossings of the next tick as unknown. The second marks the pairs as unknown too.
void cau_collide_forget_crossed(cau_collide *collide);
void cau_collide_forget(cau_collide *collide);

// Excludes a vertex from contact for the rest of the tick. The energy of its pairs is gone at the
// next evaluation.
void cau_collide_let_go(cau_collide *collide, int32_t vertex);

// Makes x the present positions. Otherwise these are the positions of the last evaluation, or those
// to which the last filter led.
void cau_collide_stand(cau_collide *collide, const double *x);

// Changes `collide->step` (m, n x 3), a wanted step from the present positions x, so that no pair
// crosses on the way. With `guess` also so that no pair comes nearer than the thickness. Returns
// whether it changed the step.
bool cau_collide_filter(cau_collide *collide, cau_pool *pool, const double *x, bool guess);

// Measures how far pairs are apart at the present positions x, for the steps near it.
void cau_collide_see(cau_collide *collide, cau_pool *pool, const double *x);

// A quick filter for the steps of an iteration, most of which are short; it does not visit all
// vertices. Whether a step of at most `longest_m` from the present positions surely keeps every
// vertex within its reach. If so, fill `collide->step` only at the corners of the `unclear` pairs.
// cau_collide_lets_pass then returns whether the step may be taken unchanged. If either returns
// false, call cau_collide_filter.
bool cau_collide_foresee(cau_collide *collide, double longest_m);
bool cau_collide_lets_pass(cau_collide *collide, const double *x, double longest_m);

// ---- between the files of this room

// find.c: searches the pairs of the vertices in `surface.changed`. False if they exceed the
// capacity.
bool cau_collide_search(cau_collide *collide, cau_pool *pool);
// order.c: sorts pairs by their parts; no two pairs have the same parts.
void cau_collide_sort(cau_collide_found *found, int32_t count);
void cau_collide_gather(cau_collide *collide); // the pairs, up to the capacity
// pair.c: whether corners may come nearer than their thickness by any allowed motion. If so, *found
// gets the pair's thickness and stiffness.
bool cau_collide_may_touch(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4],
                           cau_collide_found *found);
// reach.c: finds the pairs for x and for the motion `need`.
void cau_collide_find(cau_collide *collide, cau_pool *pool, const double *x, cau_collide_need need);
// Whether the pairs are valid for x and for the motion `need`.
bool cau_collide_covers(const cau_collide *collide, const double *x, cau_collide_need need);
// Whether they are for what is pushed, where they are for the step.
bool cau_collide_covers_pushed(const cau_collide *collide, const double *x);
// What is left of every vertex's reach at x, m, at least.
double cau_collide_slack(const cau_collide *collide, const double *x);
// How far a filtered step may lead, m, where `collide->step` is wanted.
double cau_collide_room(const cau_collide *collide, int32_t vertex);
double cau_collide_most_room(const cau_collide *collide, double step_m); // of a step so long
// What died since is looked at again; and, crossed.c, what is exempt now or is so no longer.
void cau_collide_forget_dead(cau_collide *collide);
void cau_collide_note_exempt(cau_collide *collide);

// energy.c: how far any vertex is from where pairs were measured last, m, at most.
double cau_collide_away(const cau_collide *collide, const double *x);
// Whether a pair is at least this far apart wherever vertices have been.
static inline bool cau_collide_is_far(const cau_collide *collide, int32_t pair, double away_m,
                                      double by_m)
{
	return collide->apart_m[pair] - 2 * away_m >= by_m;
}

static inline bool cau_collide_is_exempt(const cau_collide *collide, const cau_collide_pair *pair)
{
	return collide->exempt[pair->vertex[0]] | collide->exempt[pair->vertex[1]] |
	       collide->exempt[pair->vertex[2]] | collide->exempt[pair->vertex[3]];
}

static inline void cau_collide_corners(const cau_collide_pair *pair, const double *x,
                                       cau_vec3 corner[4])
{
	for (int i = 0; i < 4; i++)
		corner[i] = cau_vec3_of(x + 3 * (size_t)pair->vertex[i]);
}

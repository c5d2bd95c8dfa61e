// SPDX-License-Identifier: GPL-3.0-or-later
// Tissue against tissue: the drawn surface keeps a thickness from itself, and never crosses itself.
//
// A pair is a vertex and a face, or two edges, that share no vertex. A pair that is nearer than its
// thickness h has an energy, which is part of eq. 4 (energy.c). For the distance d the energy is
//
//     k/2 (h - d)^2 down to h/2; below, k h^2/8 + k h^2/4 log(h / 2d).
//
// The energy is continuous, with its slope and curvature [offset geometric contact, Chen et al.
// 2025]. Below 0.002 h the force grows linearly, so the force is finite even where tissue
// crossed tissue before. Friction opposes the motion since the tick's start, with the pair's force
// at that time.
//
// No step crosses (filter.c). A plane separates a pair before and after every move. Corners move
// along straight lines, so the plane separates the pair during the whole move. A corner that would
// pass the plane is moved back to its side. If that is not enough, the corner is stopped.
//
// Pairs are valid (find.c) while no vertex is farther than its `reach_m` from its `anchor`, from
// tick to tick. Positions beyond need another search. Neither the touching pairs nor the order of
// their forces depends on when pairs were searched, so no snapshot contains the pairs.
#pragma once

#include <stdatomic.h>

#include "base/pool.h"
#include "collide/gap.h"
#include "collide/lanes.h"
#include "collide/surface.h"

enum { CAU_COLLIDE_SLICE = 2048 }; // most pairs of each kind in one block
// The longest filtered step, m, unless the thickness is longer. It limits how far pairs are
// searched.
static const double cau_collide_most_step_m = 1e-3;

typedef struct cau_collide_pair {
	cau_gap_kind kind;
	int32_t vertex[4];  // corners
	double thickness_m; // m; less than the surface's thickness if the pair is nearer at rest
	double stiffness;   // k, N/m
	cau_vec3 plane;     // unit direction that separated the parts at the last measurement
	double slope;       // dE/dd at the last evaluation, N; 0: the parts are apart
	double curvature;   // d2E/dd2 at the last evaluation, N/m
	double weight[4];   // weights of the corners in the gap, at the last evaluation
	cau_vec3 normal;
} cau_collide_pair;

// The friction of a pair that touched at the tick's start.
typedef struct cau_collide_grip {
	int32_t vertex[4];
	double weight[4];
	cau_vec3 normal;
	double most_n;    // largest friction force: friction coefficient times pressing force
	double stiffness; // N/m, until the pair slides
	double present;   // N/m: force over slip, at the last evaluation
} cau_collide_grip;

typedef struct cau_collide_box {
	double least[3], most[3];
} cau_collide_box;

typedef struct cau_collide_found { // a pair as find.c lists it
	int32_t first, second;         // indices in the tissue: vertex and face, or two edges
	double thickness_m, stiffness;
} cau_collide_found;

typedef struct cau_collide_slice { // the pairs that one block found
	int32_t count[2];              // pairs of each cau_gap_kind
	bool full;
} cau_collide_slice;

// The motion for which pairs must be valid. PLACE: one position. STEP: also the wanted step from
// there, and the distance by which pushed corners may be moved beyond their step. TICK: also the
// steps of a tick that begins, as far as the capacity allows.
typedef enum cau_collide_need {
	CAU_COLLIDE_PLACE,
	CAU_COLLIDE_STEP,
	CAU_COLLIDE_TICK,
} cau_collide_need;

// Range in which the pairs are valid: no vertex is farther than its reach from its anchor.
typedef struct cau_collide_range {
	bool found;      // false: no pairs are known
	bool ahead;      // pairs are known to be valid at the positions of the next evaluation
	double *anchor;  // m, (n x 3): position around which the pairs of each vertex are known
	double *reach_m; // m, (n): radius around the anchor
} cau_collide_range;

// The last measurement of the pairs' distances.
typedef struct cau_collide_seen {
	double *at;      // m, (n x 3): positions at which pairs were last measured
	double *apart_m; // m, (most_pairs): lower bound of each pair's distance at these positions
	double slack_m;  // m: smallest remaining reach of any vertex at these positions
	double away_m;   // m: upper bound of any vertex's distance from there to its present position
} cau_collide_seen;

// The energy of the last evaluation.
typedef struct cau_collide_result {
	double energy_j;        // energy of the pairs, without friction
	int32_t touching_count; // pairs nearer than their thickness
	double steepest;        // largest ratio of curvature to stiffness of a touching pair
	uint64_t touching_hash; // hash of the pairs that are nearer than half of their thickness
} cau_collide_result;

// The vertices that had a gradient in the last evaluation: the loaded vertices.
typedef struct cau_collide_load {
	int32_t count;
	int32_t *vertex;    // (n), of which `count` are in use
	uint8_t *is_loaded; // (n): 1 at loaded vertices
	double *gradient;   // N, (n x 3): gradient of the energy; 0 at all other vertices
	double *probe;      // m, (n x 3): input of cau_collide_apply, at loaded vertices
	double *answer;     // N, (n x 3): result of cau_collide_apply, at loaded vertices
} cau_collide_load;

// find.c: result of the last search, and scratch memory.
typedef struct cau_search {
	// Boxes of the tissue's drawn faces, edges, vertices.
	cau_collide_box *face_box, *edge_box, *vertex_box;
	// Boxes of a block's faces, edges, vertices: of all, and of the fresh ones.
	cau_collide_box *block_box[3], *fresh_box[3];
	cau_collide_slice *slice;                   // (blocks)
	cau_collide_found *list[2];                 // by kind, (blocks x CAU_COLLIDE_SLICE)
	uint8_t *alive_before[CAU_PRIMITIVE_KINDS]; // elements that were alive at the last search
	// `exempt` at the last search or at the end of the last tick. All entries are 1 if this is
	// unknown.
	uint8_t *exempt_before;
	// Boxes of the parts in groups of eight, in the order in which blocks list the parts. Each
	// block begins a new group. `fresh_lane` has one bit for each part of a group: the part is
	// fresh. It is valid in touched blocks only.
	cau_collide_lanes *lane[3];
	uint8_t *fresh_lane[3];
	// (blocks + 1): begin of each block's list when the groups were laid out
	int32_t *lane_first[3];
	// ---- scratch

	int32_t touched_count, *touched;              // blocks with a fresh part
	cau_collide_lanes *block_lane, *touched_lane; // boxes of all faces of each block; boxes of the
	                                              // fresh faces of `touched` blocks
	uint8_t *is_touched;                          // (blocks): 1 if the block is in `touched`
	cau_collide_box *place_box; // (blocks): crossed.c: boxes at the present positions
	bool may_give_up;  // the search may stop early, as the result of a failed search is not used
	atomic_bool fails; // the search has failed: the pairs exceed the capacity
	atomic_int listed_count; // pairs that finished blocks have listed
} cau_search;

// filter.c: state of the last filter, and scratch memory.
typedef struct cau_filter {
	double kept_share; // least share of its distance that a pair keeps in a step
	// `held_back`: the last filter changed the step. `out_of_reach`: the filter changed the step
	// because pairs farther away are not known.
	bool held_back, out_of_reach;
	bool *stopped;   // (most_pairs): the pair has been stopped in this step
	double *wanted;  // m, (n x 3): the step before the filter changed it
	double *room_m;  // m, (n): how far a pushed vertex may move
	uint8_t *pushed; // (n): 1 at corners of pairs that came near; all 0 between calls
	bool pushes_more;
	// (most_pairs): pairs that cau_collide_foresee could not decide.
	int32_t unclear_count, *unclear;
} cau_filter;

typedef struct cau_collide {
	const cau_tissue *tissue;
	double thickness_m, friction;
	const uint8_t *fixed; // (n), n vertices; borrowed: 1 at vertices that no step moves
	// (n): vertices excluded from contact in this tick: held by jaws, inverted, diverged. They are
	// in no pair, and no filter moves them.
	uint8_t *exempt;
	// Elements that join parts while they are alive: triangles, tetrahedra, links. Borrowed. NULL:
	// all are alive.
	const uint8_t *alive[CAU_PRIMITIVE_KINDS];
	double *stiffness; // N/m, (n): contact stiffness of each vertex
	double *longest_m; // m, (n): longest edge of each vertex, at rest
	cau_surface surface;
	cau_collide_range range;
	cau_collide_seen seen;
	int32_t pair_count, most_pairs;
	cau_collide_pair *pair; // (most_pairs)
	int32_t grip_count;
	cau_collide_grip *grip; // (most_pairs)
	const double *start;    // m, (n x 3): positions at the tick's start
	double start_energy_j;
	cau_collide_result result;
	cau_collide_load load;
	double *step; // m, (n x 3): the step to be filtered
	// Counts of the tick.
	int32_t held_back_count, search_count;
	int32_t cut_short_count; // times that pairs exceeded the capacity, so that steps were shortened
	cau_search search;
	cau_filter filter;
} cau_collide;

// Creates the tissue contact of one tissue. The caller then sets `fixed` and `start` once.
cau_status cau_collide_create(cau_collide *collide, const cau_tissue *tissue, double thickness_m,
                              double friction, double step_s, cau_arena *arena, cau_error *error);

// Returns the length of the longest filtered step, m.
double cau_collide_most_step(const cau_collide *collide);

// Begins a tick at positions x (m, n x 3). Before the call, list the drawn surface and fill
// `exempt`. Set `cut_short_count` to 1 if an exclusion is to be reported, else to 0. The function
// searches pairs for steps as long as `collide->step`, measures the energy at x, and makes a grip
// of each touching pair.
void cau_collide_begin(cau_collide *collide, cau_pool *pool, const double *x);

// Returns the energy at x, J, with friction. Stores its gradient in `load`.
double cau_collide_evaluate(cau_collide *collide, cau_pool *pool, const double *x);

// Finds the pairs for x (m, n x 3) and for any motion of `count` vertices by at most way_m. Returns
// false if there are more pairs than the capacity. Must not be called while a step is filtered.
bool cau_collide_surround(cau_collide *collide, cau_pool *pool, const double *x,
                          const int32_t *vertex, int32_t count, double way_m);

// Returns the energy of one pair at x, J, with its slope (N) and curvature (N/m). If the pair is
// apart, all three are 0 and *gap may be left unchanged.
double cau_collide_press(const cau_collide *collide, int32_t pair, const double *x, cau_gap *gap,
                         double *slope, double *curvature);
// Returns the energy of one grip at x, J. The grip's force is -*present (N/m) times *slip (m).
double cau_collide_slip(const cau_collide *collide, const cau_collide_grip *grip, const double *x,
                        cau_vec3 *slip, double *present);

// Computes answer = K probe over the loaded vertices. K is the Hessian of the energy of the last
// evaluation, without its negative part.
void cau_collide_apply(cau_collide *collide);

// Excludes also the vertices that cross at x from contact. Call this before a tick in which an
// excluded vertex takes part in contact again.
void cau_collide_exempt_crossed(cau_collide *collide, const double *x);
// Whether a vertex that was excluded in the last tick takes part in contact again.
bool cau_collide_touches_again(const cau_collide *collide);
// Marks the crossings of the next tick as unknown.
void cau_collide_forget_crossed(cau_collide *collide);
// Marks the crossings of the next tick, and all pairs, as unknown.
void cau_collide_forget(cau_collide *collide);

// Excludes a vertex from contact for the rest of the tick. Its pairs have no energy from the next
// evaluation on.
void cau_collide_let_go(cau_collide *collide, int32_t vertex);

// Makes x the present positions. Without this call the present positions are those of the last
// evaluation, or those to which the last filter led.
void cau_collide_stand(cau_collide *collide, const double *x);

// Changes `collide->step` (m, n x 3), the wanted step from the present positions x, so that no pair
// crosses during the step. With `guess`, no pair comes nearer than its thickness either. Returns
// whether the step was changed.
bool cau_collide_filter(cau_collide *collide, cau_pool *pool, const double *x, bool guess);

// Measures the distances of all pairs at the present positions x. Steps from near x use these
// distances.
void cau_collide_see(cau_collide *collide, cau_pool *pool, const double *x);

// Checks quickly the steps of an iteration, most of which are short. The check does not visit all
// vertices. Returns true if a step of at most `longest_m` from the present positions surely keeps
// every vertex within its reach. Then fill `collide->step` only at the corners of the `unclear`
// pairs, and call cau_collide_lets_pass. That function returns true if the step may be taken
// unchanged. If either function returns false, call cau_collide_filter.
bool cau_collide_foresee(cau_collide *collide, double longest_m);
bool cau_collide_lets_pass(cau_collide *collide, const double *x, double longest_m);

// ---- shared by the files of core/collide, private to this folder

// find.c: searches the pairs of the vertices in `surface.changed`. Returns false if the pairs
// exceed the capacity.
bool cau_collide_search(cau_collide *collide, cau_pool *pool);
// order.c: sorts pairs by their parts; no two pairs have the same parts.
void cau_collide_sort(cau_collide_found *found, int32_t count);
// order.c: lists the pairs that all blocks found, up to the capacity.
void cau_collide_gather(cau_collide *collide);
// pair.c: true if the parts may come nearer than their thickness while each corner stays within its
// reach. If so, *found gets the pair's thickness and stiffness.
bool cau_collide_may_touch(const cau_collide *collide, cau_gap_kind kind, const int32_t vertex[4],
                           cau_collide_found *found);
// reach.c: finds the pairs for x and for the motion `need`.
void cau_collide_find(cau_collide *collide, cau_pool *pool, const double *x, cau_collide_need need);
// Whether the pairs are valid for x and for the motion `need`.
bool cau_collide_covers(const cau_collide *collide, const double *x, cau_collide_need need);
// Whether the pairs are valid for x and for the steps of pushed vertices.
bool cau_collide_covers_pushed(const cau_collide *collide, const double *x);
// Returns the smallest remaining reach of any vertex at x, m.
double cau_collide_slack(const cau_collide *collide, const double *x);
// Returns how far a filtered step may move the vertex, m, if `collide->step` is the wanted step.
double cau_collide_room(const cau_collide *collide, int32_t vertex);
// Returns how far a filtered step may move any vertex whose wanted step has the length step_m, m.
double cau_collide_most_room(const cau_collide *collide, double step_m);
// Marks the corners of elements that died since the last call as changed, so that their pairs are
// searched again.
void cau_collide_forget_dead(cau_collide *collide);
// crossed.c: marks the vertices as changed whose `exempt` differs from that at the last call.
void cau_collide_note_exempt(cau_collide *collide);

// energy.c: returns the largest distance of any vertex from where pairs were last measured, m.
double cau_collide_away(const cau_collide *collide, const double *x);
// Whether a pair is at least `by_m` apart while no vertex is more than `away_m` from where pairs
// were last measured.
static inline bool cau_collide_is_far(const cau_collide *collide, int32_t pair, double away_m,
                                      double by_m)
{
	return collide->seen.apart_m[pair] - 2 * away_m >= by_m;
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

// SPDX-License-Identifier: GPL-3.0-or-later
// The edge-based structure at work (section 6.1): exposure of edges, parted edges, share counts,
// removed elements, faces drawn.
#pragma once

#include "base/pool.h"
#include "dissect/near.h"
#include "heat/exposure.h"
#include "solve/system.h"
#include "tissue/tissue.h"

typedef struct cau_removed {
	int32_t kind, element; // cau_element_kind
} cau_removed;

// Doses of triangles and tetrahedra, where these part one by one (doses.c): arrays over all
// triangles and then all tetrahedra, NULL where edges part.
typedef struct cau_doses {
	double *dose;          // integral of u at the middle dt while that chars, degC s
	uint8_t *gone;         // has parted
	double widest_m;       // greatest half width of a cut that an element can resolve
	int32_t touched_count; // of the present tick
	int32_t *touched;
	uint8_t *touched_mark;
} cau_doses;

// What is stretched beyond what it bears (tears.c): places of triangles, then tetrahedra, then
// links.
typedef struct cau_over {
	int32_t place, counted; // ticks: a converged one counts for three
} cau_over;

typedef struct cau_tears {
	int32_t over_count;                   // at the last tick: part of the session's state
	cau_over *over;                       // ascending by place
	int32_t elements_torn;                // since creation, with what they took along
	double widest_m[CAU_PRIMITIVE_KINDS]; // greatest size of an element
	// Scratch.
	cau_over *before;
	int32_t *now, *found; // over in this tick; how many of each part
	double *load;         // of those in `now`
	int32_t *most;        // (vertex_count): the most loaded of `now` there, and 1; 0: none
} cau_tears;

typedef struct cau_dissection {
	const cau_tissue *tissue;
	uint64_t seed;
	cau_doses doses;
	cau_tears tears;
	double *exposure; // (edge_count): integral of (u_a + u_b)/2 dt while charring, degC s
	uint16_t *parted; // (edge_count): bit per layer
	uint8_t *share_count[CAU_PRIMITIVE_KINDS]; // live edges of each primitive
	cau_alive alive;
	int32_t *live_elements; // (vertex_count): live triangles, tetrahedra, links at each vertex
	uint32_t *face_mask;    // a set bit: not drawn
	uint8_t *face_owners;   // (face_count): live tetrahedra that have it; sheets: 1 while alive
	int32_t *triangle_hinge_first, *triangle_hinge; // hinges of each triangle
	// Of the present tick.
	int32_t touched_count;
	int32_t *touched; // edges that gained exposure
	uint8_t *touched_mark;
	int32_t removed_count;
	cau_removed *removed;
	// Since creation.
	int32_t edges_parted, elements_removed;
} cau_dissection;

// `parting`: CAU_PARTING_*.
cau_status cau_dissection_create(cau_dissection *dissection, const cau_tissue *tissue,
                                 uint64_t seed, int parting, cau_arena *arena, cau_error *error);

// Triangles and tetrahedra that part one by one: elements of `doses`, 0 where edges part.
int32_t cau_dissection_dose_count(const cau_dissection *dissection);

// Forgets the present tick's lists.
void cau_dissection_begin(cau_dissection *dissection);

// Exposes the edges, and the elements where these part one by one, near the tool's hot part at
// `pose` for duration_s (eq. 20). Returns the heat
// that the tissue took up, J (absorbed degrees times heat capacity of the edges' share of mass: an
// estimate).
double cau_dissection_expose(cau_dissection *dissection, const cau_near *near,
                             const double *position, const cau_heat_grid *grid,
                             const cau_tool_def *tool, const cau_pose *pose, double jaw,
                             double duration_s);

// Parts what has reached its ignition temperature: edges, with what they held up, or elements.
// Removed elements are appended to `removed`. *layers gets a bit for each layer that lost
// something.
void cau_dissection_part(cau_dissection *dissection, uint32_t *layers);

// Removes one living triangle, tetrahedron or link. Only where elements part
// (CAU_PARTING_ELEMENTS).
void cau_dissection_lose_element(cau_dissection *dissection, int primitive, int32_t index);

// Raises an edge's exposure so that cau_dissection_heated is at least `share` (0 to 1) there.
void cau_dissection_show_heated(cau_dissection *dissection, int32_t edge, double share);

// How many elements may be over what they bear, at most.
int32_t cau_tears_capacity(const cau_tissue *tissue);

// Tears what is stretched at positions x beyond what it bears, and has been for long enough:
// elements, with what their edge held up where edges part. Called once a tick; `converged`: whether
// its step has.
void cau_dissection_tear(cau_dissection *dissection, const double *position, bool converged,
                         cau_pool *pool);

// Marks the elements, by kind, that live by what has parted: `parted` (edge_count, a bit for each
// layer) and, where elements part one by one, `gone` (dose_count; else NULL).
void cau_dissection_find_alive(const cau_tissue *tissue, const uint16_t *parted,
                               const uint8_t *gone, uint8_t *const alive[CAU_ELEMENT_KINDS]);

// Recounts everything that follows from `parted` and `gone` (after a restore): share counts, alive,
// faces, vertices.
void cau_dissection_recount(cau_dissection *dissection);

// Largest exposure / ignition over the layers of an edge, 0 to 1.
double cau_dissection_heated(const cau_dissection *dissection, int32_t edge);
// 0 where all edges of an element are fresh, 1 where all are coagulated.
double cau_dissection_coagulated(const cau_dissection *dissection, int primitive, int32_t index);

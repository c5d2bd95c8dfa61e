// SPDX-License-Identifier: GPL-3.0-or-later
// Dissection by edges or elements (section 6.1): exposure of edges, parted edges, edge counts of
// elements, removed elements and drawn faces.
#pragma once

#include "base/pool.h"
#include "dissect/near.h"
#include "heat/exposure.h"
#include "solve/system.h"
#include "tissue/tissue.h"

typedef struct cau_removed {
	int32_t kind, element; // `kind` is a cau_element_kind
} cau_removed;

// Doses of triangles and tetrahedra, for scenes in which elements part one by one (doses.c). Arrays
// over all triangles, then all tetrahedra. NULL if edges part.
typedef struct cau_doses {
	double *dose;    // integral of u at the element's middle over the time that it chars, degC s
	uint8_t *gone;   // 1: the element has parted
	double widest_m; // greatest half width of the thinnest cut that an element can resolve
	int32_t touched_count; // elements that gained dose in the present tick
	int32_t *touched;
	uint8_t *touched_mark;
} cau_doses;

// An element that is stretched beyond its strength (tears.c).
typedef struct cau_over {
	// `place` is the element's index over triangles, then tetrahedra, then links. `counted` is the
	// sum of its counts: a converged tick adds three, any other tick adds one.
	int32_t place, counted;
} cau_over;

typedef struct cau_tears {
	int32_t over_count; // overloaded elements in the last tick: part of the session's state
	cau_over *over;     // overloaded elements, ascending by `place`
	// elements torn since creation, and elements removed along with torn ones
	int32_t elements_torn;
	double widest_m[CAU_PRIMITIVE_KINDS]; // greatest size of an element, by kind of primitive
	// Scratch.
	cau_over *before;
	// elements overloaded in this tick; number of elements that each part of the loop found
	int32_t *now, *found;
	double *load;  // loads of the elements in `now`
	int32_t *most; // (vertex_count): 1 + index in `now` of the most loaded element there; 0: none
} cau_tears;

typedef struct cau_dissection {
	const cau_tissue *tissue;
	uint64_t seed;
	cau_doses doses;
	cau_tears tears;
	double *exposure; // (edge_count): integral of (u_a + u_b)/2 dt while charring, degC s
	uint16_t *parted; // (edge_count): a bit for each layer in which the edge has parted
	uint8_t *share_count[CAU_PRIMITIVE_KINDS]; // number of unparted edges of each primitive
	cau_alive alive;
	int32_t *live_elements; // (vertex_count): number of live triangles, tetrahedra and links at
	                        // each vertex
	uint32_t *face_mask;    // a bit for each face; 1: not drawn
	uint8_t *face_owners; // (face_count): number of live tetrahedra with the face; a sheet's face:
	                      // 1 while alive
	int32_t *triangle_hinge_first, *triangle_hinge; // hinges of each triangle
	// State of the present tick.
	int32_t touched_count;
	int32_t *touched; // edges that gained exposure in this tick
	uint8_t *touched_mark;
	int32_t removed_count;
	cau_removed *removed;
	// Totals since creation.
	int32_t edges_parted, elements_removed;
} cau_dissection;

// Creates the state of uncut tissue. `parting` is CAU_PARTING_*. CAU_NO_MEMORY.
cau_status cau_dissection_create(cau_dissection *dissection, const cau_tissue *tissue,
                                 uint64_t seed, int parting, cau_arena *arena, cau_error *error);

// Returns the number of triangles and tetrahedra that part one by one: the length of the arrays in
// `doses`. 0 if edges part.
int32_t cau_dissection_dose_count(const cau_dissection *dissection);

// Clears the lists of the present tick.
void cau_dissection_begin(cau_dissection *dissection);

// Exposes the edges near the tool's hot part at `pose` for duration_s (eq. 20), and the elements if
// these part one by one. Returns an estimate of the heat that the tissue took up, J: absorbed
// degrees times the heat capacity of the edges' share of mass.
double cau_dissection_expose(cau_dissection *dissection, const cau_near *near,
                             const double *position, const cau_heat_grid *grid,
                             const cau_tool_def *tool, const cau_pose *pose, double jaw,
                             double duration_s);

// Parts the edges or elements that have reached their ignition temperature, and removes the
// elements of parted edges. Appends removed elements to `removed`. Sets a bit of *layers for each
// layer that lost an edge or element.
void cau_dissection_part(cau_dissection *dissection, uint32_t *layers);

// Removes one live triangle, tetrahedron or link. Only if elements part (CAU_PARTING_ELEMENTS).
void cau_dissection_lose_element(cau_dissection *dissection, int primitive, int32_t index);

// Raises an edge's exposure so that cau_dissection_heated returns at least `share` (0 to 1).
void cau_dissection_show_heated(cau_dissection *dissection, int32_t edge, double share);

// Returns the largest number of elements that can be overloaded.
int32_t cau_tears_capacity(const cau_tissue *tissue);

// Tears the elements that have been stretched beyond their strength for long enough, at
// positions x. If edges part, an edge parts with all elements at it. Called once a tick.
// `converged`: the tick's step has converged.
void cau_dissection_tear(cau_dissection *dissection, const double *position, bool converged,
                         cau_pool *pool);

// Sets `alive` for all elements by kind, from the parted edges. `parted` is (edge_count), a bit for
// each layer. `gone` is (dose_count) if elements part one by one, else NULL.
void cau_dissection_find_alive(const cau_tissue *tissue, const uint16_t *parted,
                               const uint8_t *gone, uint8_t *const alive[CAU_ELEMENT_KINDS]);

// Computes again everything that follows from `parted` and `gone`, after a restore: edge counts,
// live elements, faces, vertices.
void cau_dissection_recount(cau_dissection *dissection);

// Returns the exposure of an edge relative to ignition, 0 to 1: the largest value over the edge's
// layers.
double cau_dissection_heated(const cau_dissection *dissection, int32_t edge);
// Returns 0 if all edges of an element are fresh, 1 if all are coagulated.
double cau_dissection_coagulated(const cau_dissection *dissection, int primitive, int32_t index);

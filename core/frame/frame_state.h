// SPDX-License-Identifier: GPL-3.0-or-later
// The results of a tick that viewers need: which vertices moved, which words of the face mask
// changed, and the scalars.
#pragma once

#include "cautery/channels.h"
#include "constraint/elements_make.h"
#include "dissect/dissection.h"
#include "dissect/near.h"

typedef struct cau_frame_state {
	int32_t moved_count, mask_changed_count;
	int32_t *moved;            // (vertex_count): vertices that moved
	int32_t *mask_changed;     // (mask words): words of the face mask that changed
	uint32_t *mask_before;     // (mask words): the face mask before the tick
	uint8_t *vertex_visible;   // (vertex_count): 1 if a drawn face has the vertex
	int32_t *vertex_faces;     // (vertex_count): number of drawn faces at the vertex
	CAU_SCALAR_MEMBERS(float); // (vertex_count) each
	uint8_t *edge_burnt;       // (edge_count): 1 if the edge is counted in burnt_edges
	// (vertex_count): number of edges at the vertex that have parted in some layer.
	int32_t *burnt_edges;
	int32_t *vertex_edges; // (vertex_count): number of edges at the vertex
	float *stress_weight;  // (vertex_count): sum of the weights of the stresses at a vertex
	float ambient_c;       // temperature of the body
	int32_t heated_count;  // number of vertices that are not at ambient
	int32_t *heated;       // (vertex_count): these vertices
} cau_frame_state;

cau_status cau_frame_create(cau_frame_state *frame, const cau_tissue *tissue,
                            const cau_dissection *dissection, cau_arena *arena, cau_error *error);

// Updates the frame after a tick. `from` has the positions at the tick's start, `to` those at its
// end (n x 3).
void cau_frame_update(cau_frame_state *frame, const cau_dissection *dissection, const double *from,
                      const double *to);

// Updates the frame after a tick at rest: no vertex moved and no element was cut.
void cau_frame_stand_still(cau_frame_state *frame);

// Computes everything again, after creation and restore. Marks every vertex as moved and every word
// as changed.
void cau_frame_rebuild(cau_frame_state *frame, const cau_dissection *dissection);

// Computes the von Mises stress of the fat, weighted by volume at the vertices, Pa.
void cau_frame_stress(cau_frame_state *frame, const cau_tissue *tissue,
                      const cau_dissection *dissection, const double *position);

// Temperature at the vertices, degC. cau_frame_cool sets all vertices to ambient, once. In each
// tick cau_frame_cool_heated returns the heated vertices to ambient, and cau_frame_heat sets, for
// each tool, the vertices inside its grid. If several grids reach a vertex, the value farthest from
// ambient holds. `near` holds boxes fitted to `position`. The cost of a tick is that of the blocks'
// boxes and of the vertices in the grids.
void cau_frame_cool(cau_frame_state *frame, const cau_tissue *tissue, double ambient_c);
void cau_frame_cool_heated(cau_frame_state *frame);
void cau_frame_heat(cau_frame_state *frame, const cau_near *near, const cau_heat_grid *grid,
                    const double *position);
void cau_frame_heat_vertex(cau_frame_state *frame, int32_t vertex, float temperature);

// SPDX-License-Identifier: GPL-3.0-or-later
// What a tick made, kept for its viewers: which vertices moved, which words of the mask changed,
// scalars.
#pragma once

#include "cautery/channels.h"
#include "constraint/elements_make.h"
#include "dissect/dissection.h"
#include "dissect/near.h"

typedef struct cau_frame_state {
	int32_t moved_count, mask_changed_count;
	int32_t *moved;            // (vertex_count)
	int32_t *mask_changed;     // (mask words)
	uint32_t *mask_before;     // (mask words)
	uint8_t *vertex_visible;   // (vertex_count)
	int32_t *vertex_faces;     // (vertex_count): drawn faces at the vertex
	CAU_SCALAR_MEMBERS(float); // (vertex_count) each
	uint8_t *edge_burnt;       // (edge_count): counted in burnt_edges
	int32_t *burnt_edges;      // (vertex_count): edges at the vertex that have parted in some layer
	int32_t *vertex_edges;     // (vertex_count): edges at the vertex
	float *stress_weight;      // (vertex_count)
	float ambient_c;           // of the body
	int32_t heated_count;      // vertices away from ambient
	int32_t *heated;           // (vertex_count)
} cau_frame_state;

cau_status cau_frame_create(cau_frame_state *frame, const cau_tissue *tissue,
                            const cau_dissection *dissection, cau_arena *arena, cau_error *error);

// After a tick: from is the position at its start, to at its end (n x 3).
void cau_frame_update(cau_frame_state *frame, const cau_dissection *dissection, const double *from,
                      const double *to);

// After a tick at rest: no vertex moved and no element was cut.
void cau_frame_stand_still(cau_frame_state *frame);

// Computes everything again, with every vertex marked as moved and every word as changed (creation,
// restore).
void cau_frame_rebuild(cau_frame_state *frame, const cau_dissection *dissection);

// Von Mises stress of the fat, volume weighted at the vertices, Pa.
void cau_frame_stress(cau_frame_state *frame, const cau_tissue *tissue,
                      const cau_dissection *dissection, const double *position);

// Temperature at the vertices, degC: all of them to ambient, once; then in each tick those that
// were heated back to ambient, and for each tool what its grid says at the vertices inside it.
// Where several grids reach, the value furthest from ambient stands. `near` holds boxes fitted to
// `position`; the cost of a tick is that of the blocks' boxes and of the vertices in the grids.
void cau_frame_cool(cau_frame_state *frame, const cau_tissue *tissue, double ambient_c);
void cau_frame_cool_heated(cau_frame_state *frame);
void cau_frame_heat(cau_frame_state *frame, const cau_near *near, const cau_heat_grid *grid,
                    const double *position);
void cau_frame_heat_vertex(cau_frame_state *frame, int32_t vertex, float temperature);

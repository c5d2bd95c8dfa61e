// SPDX-License-Identifier: GPL-3.0-or-later
// Blood on the surface of the tissue: a film that flows down and forms pools (README.md).
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"
#include "base/vector.h"
#include "tissue/tissue.h"

#define CAU_BLOOD_DENSITY_KG_M3 1060.0
#define CAU_BLOOD_VISCOSITY_PA_S 3.5e-3

typedef struct cau_blood {
	int32_t vertex_count;
	double *volume_m3; // (vertex_count): volume of blood at each vertex, the state
	double *area_m2;   // (vertex_count): area of the surface around each vertex
	int32_t *degree;   // (vertex_count): number of edges at each vertex
	double *change_m3; // (vertex_count): scratch
	bool any;          // some volume is not 0
	bool flows;        // the last step moved blood
} cau_blood;

// Makes an empty film. Error: CAU_NO_MEMORY.
cau_status cau_blood_create(cau_blood *blood, const cau_tissue *tissue, cau_arena *arena,
                            cau_error *error);

// Adds blood at a position, m, to the nearest visible vertex. Does nothing if no vertex is visible.
void cau_blood_add(cau_blood *blood, const uint8_t *visible, const double *position, cau_vec3 at,
                   double volume_m3);

// Advances the flow by duration_s. Blood flows between visible vertices, along edges.
void cau_blood_flow(cau_blood *blood, const cau_edge_table *edges, const uint8_t *visible,
                    const double *position, const double gravity_m_s2[3], double duration_s);

// Returns the depth of blood at a vertex, m.
double cau_blood_depth(const cau_blood *blood, int32_t vertex);

// Computes `any` from the volumes.
void cau_blood_recount(cau_blood *blood);

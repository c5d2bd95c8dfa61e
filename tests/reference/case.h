// SPDX-License-Identifier: GPL-3.0-or-later
// A finite-element reference case: mesh, material, supports, and the equilibrium to compare with.
// README.md in this folder has the format and definitions.
#pragma once

#include <stdint.h>

#include "cautery/scene.h"
#include "cautery/status.h"

typedef struct cau_reference_case {
	char name[CAU_NAME_BYTES];
	int model; // CAU_MODEL_STVK or CAU_MODEL_NEOHOOKEAN
	double young_modulus_pa;
	double poisson_ratio;
	double density_kg_m3;
	double gravity_m_s2[3];
	double sphere_center_m[3]; // middle of the sphere in its last position
	double sphere_radius_m;    // 0 for no sphere
	double residual;           // relative residual of the reference solution
	double measure;            // N or m: block pull, tip deflection or indentation force
	double measure_converged;  // value of `measure` on a converged mesh
	double reaction_n[3];      // sum of the forces of the fixed vertices on the body
	double hold_n[3];          // sum of the forces of the prescribed vertices
	double contact_n[3];       // sum of the forces of the sphere
	int32_t vertex_count;
	int32_t tetrahedron_count;
	int32_t fixed_count;
	int32_t prescribed_count;
	int32_t contact_count;
	double *position;        // m, (vertex_count x 3), at rest
	int32_t *tetrahedron;    // vertices, (tetrahedron_count x 4), positive volume
	int32_t *fixed;          // vertices, (fixed_count)
	int32_t *prescribed;     // vertices, (prescribed_count)
	double *prescribed_move; // m, (prescribed_count x 3)
	int32_t *contact;        // vertices that touch the sphere, (contact_count)
	double *contact_force_n; // normal force of the sphere on each contact vertex, (contact_count)
	double *displacement;    // m, (vertex_count x 3): the solution
} cau_reference_case;

// Reads a case file. The caller finishes *reference, also after a failure. Errors: CAU_IO,
// CAU_BAD_SYNTAX naming the section, CAU_BAD_VALUE for a vertex out of range.
cau_status cau_reference_case_read(const char *path, cau_reference_case *reference,
                                   cau_error *error);
// Lists the vertices at z = 0 in `vertex`, which has vertex_count entries. Returns their number.
int32_t cau_reference_case_top(const cau_reference_case *reference, int32_t *vertex);
void cau_reference_case_finish(cau_reference_case *reference); // accepts a zeroed one

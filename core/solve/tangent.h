// SPDX-License-Identifier: GPL-3.0-or-later
// Finds how far tissue moves under a load on some vertices, at the present state. The answer uses
// the present stiffness of the elements. A can be several times as stiff, wherever a law is softer
// than its part of A.
//
// Let p be the load's shares (sum 1) along an axis, and H the Hessian of the elements. The
// compliance is p^T H^-1 p. It is found in a small space of motions: A^-1 p along each axis, and
// then motions of conjugate gradients for the main direction, with A as preconditioner. The product
// of H and a motion is the difference of two gradients. The answer is the best approximation in
// that space, and is never larger than the true compliance.
#pragma once

#include "base/memory.h"
#include "solve/solver.h"

enum {
	CAU_TANGENT_AXES = 3,
	CAU_TANGENT_MOTIONS = CAU_TANGENT_AXES + 2, // two motions of conjugate gradients: DECISIONS.md
};

// Scratch: a copy of the solver with its own vectors, so that the session's state does not change.
typedef struct cau_tangent {
	cau_arena arena;
	cau_step_solver probe;
	double *position;                       // m, (n x 3), positions of the probe
	cau_reals *base;                        // gradient at the present state
	cau_reals *load;                        // scratch: the load as a vector
	cau_reals *motion[CAU_TANGENT_MOTIONS]; // motions of the space, m
	cau_reals *change[CAU_TANGENT_MOTIONS]; // H times each motion, N
} cau_tangent;

// A part of a load: a vertex and its share.
typedef struct cau_tangent_load {
	int32_t vertex;
	double share;
} cau_tangent_load;

// The response of tissue to a load.
typedef struct cau_tangent_answer {
	// compliance at the load's point of application, m/N: xx, yy, zz, xy, xz, yz
	double compliance[6];
	double of_matrix; // compliance by A instead of H, equal along all axes, m/N
	double mass_kg;   // mass of the tissue that moves with the point of application
} cau_tangent_answer;

// Allocates the scratch. CAU_NO_MEMORY.
cau_status cau_tangent_create(cau_tangent *tangent, const cau_step_solver *solver,
                              cau_error *error);
void cau_tangent_finish(cau_tangent *tangent);

// Takes the solver's present state for cau_tangent_find. Called once a tick.
void cau_tangent_begin(cau_tangent *tangent, cau_step_solver *solver);

// Returns the response to loads whose shares have the sum 1. It is most accurate along `direction`,
// a unit vector. Fixed vertices do not move; if all are fixed, the response is 0. If the elements'
// energy is not positive, the response is that of A.
cau_tangent_answer cau_tangent_find(cau_tangent *tangent, const cau_tangent_load *load,
                                    int32_t count, const double direction[3]);

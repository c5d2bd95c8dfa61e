// SPDX-License-Identifier: GPL-3.0-or-later
// How far tissue gives way under a load on some vertices, at the present state: of the elements as
// they are, not of A, which is several times as stiff wherever a law is softer than its share of A.
//
// With p the load's shares (sum 1) along an axis and H the Hessian of the elements, that is
// p^T H^-1 p. It is found in a small space of motions: A^-1 p along each axis, and from there on by
// conjugate gradients for the direction that matters, with A as preconditioner. H times a motion is
// the difference of two gradients. In that space the answer is the best there is, and never larger
// than the true one.
#pragma once

#include "base/memory.h"
#include "solve/solver.h"

enum {
	CAU_TANGENT_AXES = 3,
	CAU_TANGENT_MOTIONS = CAU_TANGENT_AXES + 2, // two of conjugate gradients: DECISIONS.md
};

// Scratch: a copy of the solver with vectors of its own, so that no state changes.
typedef struct cau_tangent {
	cau_arena arena;
	cau_step_solver probe;
	double *position;                       // m, (n x 3), of the probe
	cau_reals *base;                        // gradient at the state
	cau_reals *load;                        // scratch
	cau_reals *motion[CAU_TANGENT_MOTIONS]; // m
	cau_reals *change[CAU_TANGENT_MOTIONS]; // H motion, N
} cau_tangent;

// Where a load acts: a vertex and its share.
typedef struct cau_tangent_load {
	int32_t vertex;
	double share;
} cau_tangent_load;

// How tissue answers a load.
typedef struct cau_tangent_answer {
	double compliance[6]; // its own place's, m/N: xx, yy, zz, xy, xz, yz
	double of_matrix;     // the same by A, along any axis, m/N
	double mass_kg;       // of the tissue that moves with its place
} cau_tangent_answer;

// Errors: CAU_NO_MEMORY.
cau_status cau_tangent_create(cau_tangent *tangent, const cau_step_solver *solver,
                              cau_error *error);
void cau_tangent_finish(cau_tangent *tangent);

// Makes the state of the solver the one that cau_tangent_find sees: once a tick.
void cau_tangent_begin(cau_tangent *tangent, cau_step_solver *solver);

// The answer to loads whose shares have the sum 1; it is best along `direction`, a unit vector.
// What is fixed does not move; where all of it is, the answer is 0. Where the elements give no
// positive number, it is that of A.
cau_tangent_answer cau_tangent_find(cau_tangent *tangent, const cau_tangent_load *load,
                                    int32_t count, const double direction[3]);

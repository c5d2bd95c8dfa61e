// SPDX-License-Identifier: GPL-3.0-or-later
// Estimates how far a step is from its solution, and ends a step that has reached its accuracy. The
// estimate costs one pass over the vertices in each iteration, and no solve.
//
// The error of a step is its distance to the minimum of eq. 4 in the norm of mass, relative to the
// step's own motion. It is measured over all vertices together and over each chunk of
// CAU_VERTEX_CHUNK vertices. The worst of these values counts, so that the motion of a flying flap
// does not hide an error under a tool. If the motion is slow, a larger value is used as the
// divisor, so that an error of half a micrometre is small enough. The error of a tool's force is
// relative to the force; a factor of one half weights it. Each step finds the forces from zero, in
// one solve with its first increment. Earlier steps therefore also teach how much force error the
// first increment leaves. They do not cover a push that has just begun or has changed much. For
// such a push, the estimate needs a second increment.
//
// After j increments of lengths s_1 .. s_j the error is c_j s_j. There are three sources for c_j:
// - The step itself. The norms of the gradient contract by a factor a in each iteration. The sum of
//   all further terms of such a sequence is a / (1 - a) times the last term.
// - Earlier steps, with delay [Hestenes and Stiefel 1952; Meurant and Tichy 2013]. The increments
//   that came after increment j are the error that increment j left. The largest ratio of this
//   error to s_j is kept, because the slowest mode hardly shows in a few iterations. One of every
//   dozen steps takes enough increments to learn from.
// - A bound by the energy. Where E is convex, its Hessian H is at least M / dt^2, and d = -A^-1
//   grad E is smooth. The error is then at most dt^2 |d|_A^2 / |d|_M. The error reaches this bound
//   if d consists of the slow modes that are left over when an iteration stalls.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"
#include "cautery/status.h"

typedef struct cau_step_solver cau_step_solver;

enum {
	// classes of steps with their own amplification, by number of increments: 1, 2, 3, and more
	CAU_ACCURACY_DEPTHS = 4,
	// most increments of a step that are stored; a longer step makes no estimate after that
	CAU_ACCURACY_STEPS = 64,
	CAU_ACCURACY_TOOLS = 8, // tools whose forces are compared: all that a session has
};

typedef struct cau_accuracy {
	double wanted; // largest error at which a step ends; 0: steps have a fixed number of iterations
	// What earlier steps have taught. This is part of a session's state.
	double amplification[CAU_ACCURACY_DEPTHS]; // c_j by number of increments j
	int32_t shallow_steps; // number of steps since the last step that took DEEP increments
	double force_left;     // relative error of a tool's force that the first increment leaves
	double force_before[CAU_ACCURACY_TOOLS][3]; // N, the tools' forces at the end of the last step
	// State of this step. Lengths and estimates are relative to the wanted error.
	bool moves;                                // the step moves enough to learn from
	int32_t count;                             // increments so far
	double length[CAU_ACCURACY_STEPS];         // s_j, or |d| if |d| is larger
	double norm[CAU_ACCURACY_STEPS];           // |d| in the norm of A, J^(1/2)
	double force[CAU_ACCURACY_TOOLS][3];       // N, the tools' forces after the last increment
	double force_first[CAU_ACCURACY_TOOLS][3]; // N, the tools' forces after the first increment
	double left;                               // estimate of the error from this step alone
	double error; // estimate of the error, relative to motion; 0: no estimate was made
	double *sums; // (chunk_count x 4): scratch
} cau_accuracy;

cau_status cau_accuracy_create(cau_accuracy *accuracy, int32_t chunk_count, cau_arena *arena,
                               cau_error *error);
// Discards what steps have taught.
void cau_accuracy_forget(cau_accuracy *accuracy);
// Begins the estimate of a step. Called again if the step restarts from another guess.
void cau_accuracy_begin(cau_accuracy *accuracy);
// True if the step has reached its accuracy after its trial increment. `norm` is the norm, in A, of
// the increment from which the trial increment was mixed.
bool cau_accuracy_is_reached(cau_step_solver *solver, double norm);
// Ends a step: updates the amplifications from the increments that the step took.
void cau_accuracy_learn(cau_accuracy *accuracy);

// SPDX-License-Identifier: GPL-3.0-or-later
// How far a step is from its solution, and whether that is near enough: what ends a step that has
// an accuracy to reach. The estimate costs one pass over the vertices an iteration, and no solve.
//
// The error of a step is the distance to the minimum of eq. 4 in the norm of mass, relative to the
// step's own motion: of all vertices together and of each chunk of CAU_VERTEX_CHUNK, whichever is
// worst, so that a flap that flies does not hide what happens under a tool. Motion counts for as
// much at least as makes half a micrometre of error enough. Forces of tools count by half, relative
// to themselves. Each step finds them from nothing, in one solve with its first increment, so that
// what this leaves of them is taught by the steps before, too; a push that has just begun or
// changed much is not what these have seen, and takes a second increment to be told.
//
// After j increments of lengths s_1 .. s_j the error is c_j s_j. What c_j is
// - the step itself tells: the norms of the gradient contract by a factor a in each iteration, and
//   what is left of such a sequence is a / (1 - a) of its last term;
// - the steps before tell: with delay [Hestenes and Stiefel 1952; Meurant and Tichy 2013] the
//   increments that came after the j-th are the error that it left, and the largest such ratio is
//   carried on, as the mode that is slowest here has hardly begun to show in a few iterations. Of
//   every dozen steps one goes deep enough to learn from;
// - the energy bounds: H, its Hessian, is M / dt^2 at least where it is convex, and d = -A^-1 grad
//   E is smooth, so that the error is dt^2 |d|_A^2 / |d|_M at most where d is all in the slow modes
//   that are left over when an iteration stalls.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"
#include "cautery/status.h"

typedef struct cau_step_solver cau_step_solver;

enum {
	CAU_ACCURACY_DEPTHS = 4, // iterations whose amplification is told apart: 1, 2, 3, and more
	CAU_ACCURACY_STEPS = 64, // increments that are remembered; later ones end a step unlearned from
	CAU_ACCURACY_TOOLS = 8,  // whose forces are looked at: all that a session has
};

typedef struct cau_accuracy {
	double wanted; // largest error at which a step ends; 0: steps have a number of iterations
	// What steps have taught, part of a session's state.
	double amplification[CAU_ACCURACY_DEPTHS]; // c_j
	int32_t shallow_steps;                     // since one that went deep
	double force_left; // of a tool's force, what the first increment leaves it off
	double force_before[CAU_ACCURACY_TOOLS][3]; // N, of the tools at the last step's end
	// Of this step; lengths and estimates relative to what is wanted.
	bool moves;                                // there is something to learn from
	int32_t count;                             // increments
	double length[CAU_ACCURACY_STEPS];         // s_j, and |d| where that is more
	double norm[CAU_ACCURACY_STEPS];           // |d| in the norm of A, J^(1/2)
	double force[CAU_ACCURACY_TOOLS][3];       // N, of the tools after the last increment,
	double force_first[CAU_ACCURACY_TOOLS][3]; // and after the first
	double left;                               // estimate from this step alone
	double error;                              // estimate, relative to motion; 0: none was made
	double *sums;                              // (chunk_count x 4): scratch
} cau_accuracy;

cau_status cau_accuracy_create(cau_accuracy *accuracy, int32_t chunk_count, cau_arena *arena,
                               cau_error *error);
// What steps have taught is as at the beginning.
void cau_accuracy_forget(cau_accuracy *accuracy);
// A step begins, or begins again where its guess was given up.
void cau_accuracy_begin(cau_accuracy *accuracy);
// Whether the step is near enough once it has taken its trial increment; `norm`: of the increment
// that was mixed into it, in the norm of A.
bool cau_accuracy_is_reached(cau_step_solver *solver, double norm);
// A step has ended: what it teaches.
void cau_accuracy_learn(cau_accuracy *accuracy);

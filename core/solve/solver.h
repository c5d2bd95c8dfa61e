// SPDX-License-Identifier: GPL-3.0-or-later
// One time step: the minimum of eq. 4 by alternating a local step (project every element, eq. 6)
// and a global one (one constant system, eq. 7), as the quasi-Newton iteration x <- x - A^-1 grad
// E, for increments. Anderson acceleration in the norm of A; backtracking on eq. 4, and on the work
// along the step where a law has no energy.
//
// Vectors of reals (vectors.h) hold four a vertex, x, y, z and 0; those of doubles hold three.
#pragma once

#include "base/pool.h"
#include "collide/collide.h"
#include "constraint/elements_make.h"
#include "solve/accuracy.h"
#include "solve/kernels.h"
#include "solve/newton.h"
#include "solve/system.h"

enum {
	CAU_MAX_BACKTRACKS = 8,
	// Elements times iterations that a step may take to reach its accuracy. 30 ns each on one core
	// of an AMD EPYC: five milliseconds, a third of a tick of 60 Hz. Small tissue can have many
	// iterations.
	CAU_SOLVER_EFFORT = 160000,
	CAU_NEWTON_COST =
		14, // of an element that Newton's method assembles, in elements of an iteration
	CAU_VERTEX_CHUNK = 256, // vertices in one share of a vertex loop
};

// Forces on vertices that are neither inertia nor elements: drag in char.
// Its energy is c / (2 dt) |x - x_t - carried|^2.
typedef struct cau_drag {
	int32_t vertex;
	double coefficient; // c / dt, N/m
	double target[3];   // x_t + carried, m
} cau_drag;

typedef struct cau_contact_set cau_contact_set;

// Vectors of a conjugate gradient, made with solver->collide.
typedef struct cau_yield {
	cau_reals *residual, *solved, *direction, *image; // image = A direction
} cau_yield;

struct cau_step_solver {
	const cau_tissue *tissue;
	const cau_kernels *kernels;
	cau_pool *pool;
	cau_elements elements;
	cau_element_slots slots;
	cau_system system;
	cau_factor *factor;
	cau_sweep sweep;
	cau_loose loose;         // made by the first step
	int64_t whole_panels;    // bytes: larger panels of single precision are narrow
	uint64_t factor_version; // counts every change of the factor
	uint64_t factor_epoch;   // counts those that leave nothing of the old one

	bool diagonal;      // CAU_SOLVER_DIAGONAL
	bool conservative;  // every law is the gradient of an energy
	bool newton_chosen; // CAU_SOLVER_NEWTON: all sheets are taken for loose
	bool none_loose;    // in this tick: tissue is inverted, diverges or crosses (exempt.c)
	int32_t iterations; // of a step, at most; with an accuracy to reach, see CAU_SOLVER_EFFORT
	double tolerance;
	double stiffness_j; // mean weight of triangles and tetrahedra
	double step_s;      // one tick
	double inertia_s;   // h of M / h^2 in eq. 4 and in A: step_s with implicit Euler
	cau_accuracy accuracy;
	const uint8_t *fixed; // (vertex_count): pinned or frozen

	double *position;             // x, (n x 3), of the session
	double *predicted;            // s of eq. 4, (n x 3)
	const double *position_start; // x_t, (n x 3); NULL: no second guess
	double *external;             // N, (n x 3)
	cau_drag *drag;
	int32_t drag_count;
	cau_contact_set *contact; // NULL: none
	cau_collide *collide;     // likewise: tissue against tissue

	cau_reals *displacement;    // u = x - X
	cau_reals *gradient;        // grad of eq. 4
	cau_reals *increment;       // d = -A^-1 grad
	cau_reals *trial_increment; // the step that is taken
	cau_yield yield;            // yield.c: scratch, where tissue touches tissue
	cau_history history;        // its step is trial_increment
	double anderson_product[CAU_ANDERSON_WINDOW][CAU_ANDERSON_WINDOW]; // df_i . A df_j
	double *chunk_energy;                                              // (chunk_count)
	double *chunk_dot;       // (chunk_count x 2 CAU_ANDERSON_WINDOW)
	double *position_before; // (n x 3)
	int32_t chunk_count;

	double (*now_s)(void); // NULL: no timing

	double objective; // J, of the guess, once the step has begun, and of where it has ended
	// Of the last step.
	bool spared; // its end was not evaluated: elements' energies are of just before it
	double local_s, contact_s;
	int32_t iterations_done, backtracks;
	double residual; // |grad| in the norm of A^-1, relative to the first iteration's
};

// Elements, pattern and vectors. The system is factored by cau_solver_factor once the laws are set.
cau_status cau_solver_create(cau_step_solver *solver, const cau_scene_def *scene,
                             const cau_tissue *tissue, cau_arena *arena, cau_error *error);
// Assembles and factors A over the live elements; `permutation` as in cau_factor_create. In two:
// cau_solver_analyse assembles it and finds the factor's pattern (solver->factor stays NULL where
// none is needed), cau_solver_make_factor makes the numbers.
cau_status cau_solver_analyse(cau_step_solver *solver, const cau_alive *alive,
                              const int32_t *permutation, cau_error *error);
cau_status cau_solver_make_factor(cau_step_solver *solver, cau_arena *arena, cau_error *error);
cau_status cau_solver_factor(cau_step_solver *solver, const cau_alive *alive,
                             const int32_t *permutation, cau_arena *arena, cau_error *error);
void cau_solver_finish(cau_step_solver *solver);

// Whether every law of the tissue is the gradient of an energy.
bool cau_solver_is_conservative(const cau_tissue *tissue, bool diagonal);

// Solves the step from the guess in solver->position. CAU_NUMERICAL if the state is not finite.
cau_status cau_solver_run(cau_step_solver *solver, cau_error *error);
// The same in two: the first local step, beside which one thread does `meanwhile`, and the rest.
void cau_solver_begin(cau_step_solver *solver, void (*meanwhile)(void *context), void *context);
cau_status cau_solver_descend(cau_step_solver *solver, cau_error *error);

// ---- stages, in files of their own

// evaluate.c: gradient and objective (J, in double, fixed order) of eq. 4 at the present position.
double cau_solver_evaluate(cau_step_solver *solver);
// Likewise, while one thread does `meanwhile`, which may change neither position nor elements.
double cau_solver_evaluate_beside(cau_step_solver *solver, void (*meanwhile)(void *context),
                                  void *context);
// The displacements alone, and the rest.
void cau_solver_displace(cau_step_solver *solver);
double cau_solver_evaluate_displaced(cau_step_solver *solver);
// Before a solve: viscosity takes strain at the present position for R (viscous_kernel.h), or that
// share of the way from the present R to it. Nothing without viscosity.
void cau_solver_take_strain(cau_step_solver *solver, double share);
// Sum of elements' energies of the last evaluation without viscosity's, J.
double cau_solver_elastic_energy(const cau_step_solver *solver);
// The other part, J: half of what viscosity takes in h, at that strain rate.
double cau_solver_viscous_energy(const cau_step_solver *solver);
// global.c: increment = -A^-1 gradient, with unilateral constraints if there are any.
void cau_solver_global(cau_step_solver *solver);
// inverse.c: plain A^-1 applied: out = sign * A^-1 in (by vertex; rows of fixed vertices come out
// zero).
void cau_solver_apply_inverse(cau_step_solver *solver, const cau_reals *in, cau_reals *out,
                              double sign);
// yield.c: its vectors; makes increment = -(A + K)^-1 gradient of -A^-1 gradient, K the stiffness
// of tissue on tissue.
cau_status cau_solver_make_yield(cau_step_solver *solver, cau_arena *arena, cau_error *error);
void cau_solver_yield(cau_step_solver *solver);
// apart.c: shortens trial_increment, to be taken from positions `from`, so that tissue crosses no
// tissue. Returns whether it had to.
bool cau_solver_keep_apart(cau_step_solver *solver, const double *from);
// What rounding can do to E, J, where a step promises to lower it by `promise`.
double cau_solver_noise(const cau_step_solver *solver, double promise);
// Where a first increment throws anything farther than all that a tick's iterations may lead
// together, what it would have to be shortened for touches nothing in this tick. Returns whether
// that is so: then the increment is another.
bool cau_solver_let_go(cau_step_solver *solver);
// The vertices of a share of a vertex loop: [first, returned).
int32_t cau_solver_chunk_end(const cau_step_solver *solver, int32_t chunk, int32_t *first);
// anderson.c: trial_increment from increment and the history of this step. What is mixed is kept,
// once it is done with, by giving the next increment and gradient other arrays.
void cau_anderson_start(cau_step_solver *solver);
bool cau_anderson_mix(cau_step_solver *solver, int32_t iteration);
void cau_anderson_keep(cau_step_solver *solver);

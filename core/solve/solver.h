// SPDX-License-Identifier: GPL-3.0-or-later
// Solves one time step: finds the minimum of eq. 4. A local step (project every element, eq. 6)
// alternates with a global step (one constant linear system, eq. 7). Together they are the
// quasi-Newton iteration x <- x - A^-1 grad E, computed by increments. Anderson acceleration in the
// norm of A makes it faster. Backtracking uses eq. 4, or the work along the step if a law has no
// energy.
//
// Vectors of reals (vectors.h) hold four reals for each vertex: x, y, z and 0. Vectors of doubles
// hold three.
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
	// Largest number of elements times iterations in a step that has a wanted accuracy. One element
	// in one iteration costs 30 ns on one core of an AMD EPYC, so the limit is five milliseconds, a
	// third of a tick of 60 Hz. Small tissue can therefore have many iterations.
	CAU_SOLVER_EFFORT = 160000,
	CAU_NEWTON_COST = 14,   // cost of an element in Newton's assembly, over that in an iteration
	CAU_VERTEX_CHUNK = 256, // vertices in one chunk of a vertex loop
};

// Forces on vertices that are neither inertia nor elements: drag in char.
// Its energy is c / (2 dt) |x - x_t - carried|^2.
typedef struct cau_drag {
	int32_t vertex;
	double coefficient; // c / dt, N/m
	double target[3];   // x_t + carried, m
} cau_drag;

typedef struct cau_contact_set cau_contact_set;

// Vectors of a conjugate gradient. They are allocated with solver->collide.
typedef struct cau_yield {
	cau_reals *residual, *solved, *direction, *image; // image = A direction
} cau_yield;

// How steps are solved, as the scene says.
typedef struct cau_solver_settings {
	bool diagonal;      // diagonal system instead of A: CAU_SOLVER_DIAGONAL
	bool newton_chosen; // CAU_SOLVER_NEWTON: all sheets are treated as loose
	bool conservative;  // every law is the gradient of an energy
	// most iterations of a step; if the step has a wanted accuracy, see CAU_SOLVER_EFFORT
	int32_t iterations;
	double tolerance;
	double stiffness_j; // J: mean weight of triangles and tetrahedra
} cau_solver_settings;

// Changes of the factor so far.
typedef struct cau_factor_age {
	uint64_t version; // number of changes
	uint64_t epoch;   // number of changes that keep nothing of the old factor
} cau_factor_age;

// Forces on the vertices besides inertia, elements and contact.
typedef struct cau_forces {
	double *external; // N, (n x 3)
	cau_drag *drag;
	int32_t drag_count;
} cau_forces;

// Vectors of an iteration.
typedef struct cau_iterate {
	cau_reals *displacement; // u = x - X
	cau_reals *gradient;     // grad of eq. 4
	cau_reals *increment;    // d = -A^-1 grad
	cau_reals *trial;        // the mixed or shortened increment that is tried
	double *before;          // m, (n x 3): positions before the step
} cau_iterate;

// Chunks of CAU_VERTEX_CHUNK vertices: sums of each.
typedef struct cau_chunks {
	int32_t count;
	double *energy; // (count): J
	double *dot;    // (count x 2 CAU_ANDERSON_WINDOW)
} cau_chunks;

// Anderson acceleration (anderson.c).
typedef struct cau_anderson {
	cau_history history;                                      // history.step is the iterate's trial
	double product[CAU_ANDERSON_WINDOW][CAU_ANDERSON_WINDOW]; // df_i . A df_j
} cau_anderson;

// Results of the last step.
typedef struct cau_solver_result {
	// J: value of eq. 4, at the guess once the step has begun, at the solution once it has ended
	double objective;
	bool spared; // the end of the step was not evaluated: the elements' energies are of the iterate
	             // before it
	double local_s, contact_s;
	int32_t iterations, backtracks;
	double residual; // |grad| in the norm of A^-1, relative to that of the first iteration
} cau_solver_result;

struct cau_step_solver {
	const cau_tissue *tissue;
	const cau_kernels *kernels;
	cau_pool *pool;
	cau_elements elements;
	cau_element_slots slots;
	cau_system system;
	cau_factor *factor;
	cau_factor_age age;
	cau_sweep sweep;
	cau_loose loose;      // allocated in the first step
	int64_t whole_panels; // size in bytes above which panels of single precision are narrow

	cau_solver_settings settings;
	bool none_loose;  // in this tick no tissue counts as loose: some is inverted, diverges or
	                  // crosses (session/meet.c)
	double step_s;    // s: one tick
	double inertia_s; // s: h of M / h^2 in eq. 4 and in A: step_s with implicit Euler
	cau_accuracy accuracy;

	const uint8_t *fixed;         // (vertex_count): pinned or frozen
	double *position;             // x, (n x 3): the session's positions
	double *predicted;            // s of eq. 4, (n x 3)
	const double *position_start; // x_t, (n x 3); NULL: a step does not restart from x_t
	cau_forces forces;
	cau_contact_set *contact; // contact of tools; NULL: none
	cau_collide *collide;     // tissue contact; NULL: none

	cau_iterate iterate;
	cau_chunks chunks;
	cau_yield yield; // scratch of yield.c, for tissue contact
	cau_anderson anderson;
	double (*now_s)(void); // clock for timings; NULL: no timings
	cau_solver_result result;
};

// Allocates elements, pattern and vectors. The system is factored by cau_solver_factor once the
// laws are set.
cau_status cau_solver_create(cau_step_solver *solver, const cau_scene_def *scene,
                             const cau_tissue *tissue, cau_arena *arena, cau_error *error);
// Assembles and factors A over the live elements; `permutation` as in cau_factor_create. The two
// parts are also separate functions. cau_solver_analyse assembles A and finds the factor's pattern;
// solver->factor stays NULL if no factor is needed. cau_solver_make_factor computes the factor's
// values.
cau_status cau_solver_analyse(cau_step_solver *solver, const cau_alive *alive,
                              const int32_t *permutation, cau_error *error);
cau_status cau_solver_make_factor(cau_step_solver *solver, cau_arena *arena, cau_error *error);
cau_status cau_solver_factor(cau_step_solver *solver, const cau_alive *alive,
                             const int32_t *permutation, cau_arena *arena, cau_error *error);
void cau_solver_finish(cau_step_solver *solver);

// True if every law of the tissue is the gradient of an energy.
bool cau_solver_is_conservative(const cau_tissue *tissue, bool diagonal);

// Solves the step from the guess in solver->position. CAU_NUMERICAL if the state is not finite.
cau_status cau_solver_run(cau_step_solver *solver, cau_error *error);
// Two parts of cau_solver_run: cau_solver_begin does the first local step, while one thread calls
// `meanwhile`; cau_solver_descend does the rest.
void cau_solver_begin(cau_step_solver *solver, void (*meanwhile)(void *context), void *context);
cau_status cau_solver_descend(cau_step_solver *solver, cau_error *error);

// ---- stages, in files of their own

// evaluate.c: computes the gradient of eq. 4 at the present position, and returns the objective (J,
// in double, summed in a fixed order).
double cau_solver_evaluate(cau_step_solver *solver);
// Does the same as cau_solver_evaluate while one thread calls `meanwhile`. `meanwhile` may change
// neither position nor elements.
double cau_solver_evaluate_beside(cau_step_solver *solver, void (*meanwhile)(void *context),
                                  void *context);
// Two parts of cau_solver_evaluate: the displacements, and all the rest.
void cau_solver_displace(cau_step_solver *solver);
double cau_solver_evaluate_displaced(cau_step_solver *solver);
// Called before a solve. Takes the strain at the present position as viscosity's reference R
// (viscous_kernel.h), or moves R by `share` of the way to it. Does nothing without viscosity.
void cau_solver_take_strain(cau_step_solver *solver, double share);
// The elements' elastic energy, J: the sum of the last evaluation without viscosity's part.
double cau_solver_elastic_energy(const cau_step_solver *solver);
// The elements' viscous energy, J: half of the power of viscosity times h, at the present strain
// rate.
double cau_solver_viscous_energy(const cau_step_solver *solver);
// global.c: increment = -A^-1 gradient, with contact constraints if there are any.
void cau_solver_global(cau_step_solver *solver);
// inverse.c: applies A^-1 without constraints: out = sign * A^-1 in (by vertex). Fixed vertices get
// 0.
void cau_solver_apply_inverse(cau_step_solver *solver, const cau_reals *in, cau_reals *out,
                              double sign);
// yield.c: allocates its vectors; turns increment = -A^-1 gradient into -(A + K)^-1 gradient. K is
// the stiffness of tissue contact.
cau_status cau_solver_make_yield(cau_step_solver *solver, cau_arena *arena, cau_error *error);
void cau_solver_yield(cau_step_solver *solver);
// apart.c: shortens iterate.trial, which starts at positions `from`, so that tissue does not
// cross tissue. Returns true if it was shortened.
bool cau_solver_keep_apart(cau_step_solver *solver, const double *from);
// evaluate.c: the change of E, J, that rounding alone can make in a step that promises to lower E
// by `promise`.
double cau_solver_noise(const cau_step_solver *solver, double promise);
// apart.c: checks a first increment. If it moves a vertex farther than all iterations of a tick
// together may lead, the vertices that move too far are excluded from contact in this tick. Returns
// true if so: the increment must then be computed again.
bool cau_solver_let_go(cau_step_solver *solver);
// Returns the end of a vertex chunk's range [*first, returned).
int32_t cau_solver_chunk_end(const cau_step_solver *solver, int32_t chunk, int32_t *first);
// anderson.c: mixes iterate.trial from the increment and the history of this step.
// cau_anderson_keep adds the mixed increment and gradient to the history by exchanging arrays.
void cau_anderson_start(cau_step_solver *solver);
bool cau_anderson_mix(cau_step_solver *solver, int32_t iteration);
void cau_anderson_keep(cau_step_solver *solver);

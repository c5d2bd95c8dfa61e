// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method in loose tissue. A, which x, y and z share, takes a sheet to be as stiff across
// its plane as within it. A tab along a cut, a flap or a sheet that hangs by an edge is soft there:
// only mass and tension resist, and a step by A leaves 70 to 90 % of its motion undone.
//
// So the vertices of slack triangles (CAU_SLACK) and of sheets with a range form a region R, if R
// has at most CAU_NEWTON_ROWS vertices. N has all other vertices. Each iteration has two parts:
//
//   settle     moves R to where E is least with N held still, by Newton's method in double with a
//              line search of R's own share of E;
//   increment  d = -M^-1 grad E, where M has the Hessian H in R and between R and N, and in N the
//              Schur complement of A. With A = [A_RR A_RN; A_NR A_NN] it takes one solve by H_RR,
//              one by A, and another by H_RR:
//                  e = -H_RR^-1 g_R,   d_N = -(A^-1 (0; g_N + H_NR e))_N,
//                  d_R = -H_RR^-1 (g_R + H_RN d_N).
//
// M is symmetric and positive definite, so Anderson acceleration works in its norm. Vertices near a
// tool and vertices of fat belong to N, because contact uses the columns of A^-1.
//
// Where tissue touches tissue, E includes the energy of the pairs and grips of R (newton_touch.c).
// A vertex that touches moves by less than half of the gap in a step of Newton's method. The
// settled positions are filtered as every step is (apart.c), so no tissue crosses. In a tick in
// which tissue is inverted, diverges or crosses other tissue, R is empty. In trials, such tissue
// recovered by steps of A, and not by steps of Newton's method.
//
// H has a block of 3 x 3 for each pair of vertices. A negative eigenvalue of an element's part is
// replaced by its absolute value, or by 0 if the last step was too short [Chen, Xu and Jacobson
// 2024]. Negative eigenvalues occur in a tab that is pressed together and buckles. With 0 the tab
// moves too far. With absolute values alone, steps are too short where other elements outweigh the
// negative eigenvalues. No result depends on an earlier step, so snapshots hold no state of
// Newton's method.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_step_solver cau_step_solver;

enum {
	CAU_BLOCK = 12, // doubles of a 3 x 3 block: three columns of four, the last of each 0
	// Most rows of a region. With 2,050 rows a step of a session took 28 ms (DECISIONS.md), more
	// than a tick of 60 Hz. A scene that asks for Newton's method has no such limit.
	CAU_NEWTON_ROWS = 1024,
	// Most elements that Newton's method assembles in one step of a session: about ten milliseconds
	// of work. Beyond that number the step continues with A, and the step's reported error includes
	// the motion left undone. A scene that asks for Newton's method has no such limit.
	CAU_NEWTON_WORK = 24000,
};

// An element: a slot in a share of the local step.
typedef struct cau_newton_element {
	int32_t work, slot;
} cau_newton_element;

// A block of H between a row and a free vertex outside R.
typedef struct cau_newton_coupling {
	int32_t row, vertex;
	double block[9]; // N/m, by rows
} cau_newton_coupling;

// Capacities of the arrays.
typedef struct cau_newton_capacity {
	int32_t rows, blocks, elements, couplings, pairs, grips;
} cau_newton_capacity;

// H_RR = L D L^T in blocks. Each vertex of R has one row of blocks, in the order of the factor of
// A. Before the factorisation `block` and `pivot` hold H_RR.
typedef struct cau_newton {
	int32_t n;        // number of rows; 0: R is empty
	uint8_t *chosen;  // (vertex_count): 1 for each vertex of R
	int32_t *place;   // (vertex_count): row of each vertex, -1 outside R
	int32_t *vertex;  // (n): vertex of each row
	int32_t *first;   // (n + 1): where the blocks of each column of L, below its diagonal, begin
	int32_t *row;     // (first[n]): row of each block, ascending in a column
	double *block;    // (first[n] x CAU_BLOCK): the blocks of L, N/m
	double *pivot;    // (n x CAU_BLOCK): D, N/m
	double *inverse;  // (n x CAU_BLOCK): D^-1, m/N
	double *column;   // (n x CAU_BLOCK): the column that is being computed, by row
	double *field;    // (n x 4): right-hand side and solution
	double *gradient; // (n x 4): gradient of E, N
	double *from;     // (n x 4): positions before a step, m; or a solution that is kept
	int32_t *next, *head, *at; // (n): lists of the columns that have a block in a row
	cau_newton_capacity capacity;
	int32_t element_count, coupling_count;
	cau_newton_element *element; // (element_count): elements with a vertex in R
	cau_newton_coupling *coupling;
	int32_t *pair, *grip; // indices of the pairs and grips of tissue contact with a vertex in R
	int32_t pair_count, grip_count;
	double *room;    // (n): longest motion of each vertex in one step, m; INFINITY: not in contact
	double energy;   // J: R's share of E: inertia, drag, and all elements with a vertex in R
	double negative; // factor on the absolute value that replaces a negative eigenvalue: 1 or 0
} cau_newton;

// The solver's state of Newton's method.
typedef struct cau_loose {
	cau_newton region, part; // R, and the part of it that still moves
	uint8_t *before;         // (vertex_count): R of the last step
	uint64_t epoch;          // epoch of the factor from which `before` has its order
	uint8_t *in_fat;         // (vertex_count): vertices of fat
	int32_t share_count;     // shares of the local step that have triangles without a vertex of fat
	int32_t *share;
	// (work_count): whether the share has a triangle without a vertex of fat and with a range
	bool *ranged;
	int64_t work;   // elements assembled so far in this step
	bool settled;   // R's share of E is at its minimum
	bool moved;     // R has moved in this settling
	double left;    // if not settled: length of R's last step, relative to R's motion in the tick
	bool fresh;     // H is factored at R's present position
	bool given_up;  // Newton's method is not used for the rest of this step
	double way_m;   // with tissue contact: how far R's vertices may move in one settling
	double still_m; // m: R is settled once no vertex moves farther in a step of Newton's method
} cau_loose;

// Chooses R for this step, at the step's first guess. CAU_NO_MEMORY.
cau_status cau_loose_choose(cau_step_solver *solver, cau_error *error);
// Settles R while all other vertices are held. Changes position, displacement, gradient and
// *objective. CAU_NO_MEMORY.
cau_status cau_loose_settle(cau_step_solver *solver, double *objective, cau_error *error);
// increment = -M^-1 gradient. R must be settled.
void cau_loose_increment(cau_step_solver *solver);
void cau_loose_finish(cau_loose *loose);

// ---- stages, in files of their own

// newton_pattern.c: makes the region of the `chosen` vertices: its rows, its elements, and the
// pattern of its factor. The elements are those of `from` that have a row; if `from` is NULL, of
// all shares. Returns false if there is no memory.
bool cau_newton_create(cau_newton *newton, const cau_step_solver *solver, const cau_newton *from);
void cau_newton_finish(cau_newton *newton);
// newton_hessian.c: cau_newton_assemble computes H, gradient and energy at the present position,
// and returns false if there is no memory. cau_newton_measure computes gradient and energy only.
bool cau_newton_assemble(cau_newton *newton, const cau_step_solver *solver);
void cau_newton_measure(cau_newton *newton, const cau_step_solver *solver);
// newton_touch.c: lists the pairs and grips of tissue contact that have a row, out of those in
// `from`. If `from` is NULL, out of all. Returns false if there is no memory.
bool cau_newton_find_touching(cau_newton *newton, const cau_step_solver *solver,
                              const cau_newton *from);
// Adds the energy, gradient and stiffness of tissue contact, and computes `room`.
void cau_newton_touch(cau_newton *newton, const cau_step_solver *solver);
// Returns the stiffness of a triangle in its softest direction, as a share of A's stiffness. For a
// triangle with a range, returns CAU_NEWTON_RANGE: such a triangle has no stiffness within its
// range.
#define CAU_NEWTON_RANGE (-1.0)
double cau_newton_stiffness(const cau_step_solver *solver, const cau_newton_element *triangle);

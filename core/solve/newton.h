// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's step for sheets that hang free: d = -H^-1 grad E, H the Hessian of eq. 4 with what is
// negative of each element's left out [Smith et al. 2019, Kim 2020].
//
// A, which x, y and z share, takes a sheet to be as stiff across its plane as within it. A sheet
// that is held on one side only is soft there: nothing but mass and tension resists, and the
// iteration by A leaves 70 to 90 % of such a step undone. H has a block of 3 x 3 for each pair of
// vertices, is made anew for each iteration and factored in blocks, in the order that was found for
// A. Nothing of it is kept from one iteration to the next, so that a snapshot has none of it.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_step_solver cau_step_solver;

enum {
	CAU_BLOCK = 12, // doubles of a 3 x 3 block: three columns of four, the last of each 0
};

// H = L D L^T in blocks, one row of blocks a free vertex, in the order of the factor of A. Before
// it is factored `block` and `pivot` hold H.
typedef struct cau_newton {
	int32_t n;                 // rows of blocks; 0: not made yet
	int32_t *place;            // (vertex_count): row of each vertex, -1 where it is pinned
	int32_t *first;            // (n + 1): blocks of each column of L below its diagonal
	int32_t *row;              // (first[n]): ascending
	double *block;             // (first[n] x CAU_BLOCK): N/m
	double *pivot;             // (n x CAU_BLOCK): D, N/m
	double *inverse;           // (n x CAU_BLOCK): D^-1, m/N
	double *column;            // (n x CAU_BLOCK): the column that is worked on, by row
	double *field;             // (n x 4): right-hand side and solution
	int32_t *next, *head, *at; // (n): which columns have come to which row
} cau_newton;

// Whether this step is taken by Newton's method: the scene asks for it, its tissue is sheets with
// energies and what ties them, and no tool touches it, for contact is corrected by columns of A^-1.
bool cau_newton_is_called_for(const cau_step_solver *solver);
// increment = -H^-1 gradient at the present position. CAU_NO_MEMORY: at the first step only.
// CAU_NUMERICAL: H is not positive definite, as where the state is not finite.
cau_status cau_newton_increment(cau_step_solver *solver, cau_error *error);
void cau_newton_finish(cau_newton *newton);

// ---- stages, in files of their own

// newton_pattern.c: room for H and its factor.
cau_status cau_newton_create(cau_newton *newton, const cau_step_solver *solver, cau_error *error);
// newton_hessian.c: H at the present position.
void cau_newton_assemble(cau_newton *newton, const cau_step_solver *solver);

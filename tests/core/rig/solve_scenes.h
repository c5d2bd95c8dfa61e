// SPDX-License-Identifier: GPL-3.0-or-later
// Systems of different shapes for tests of the solver.
#pragma once

#include "core/rig/rig.h"

typedef struct solve_scene {
	const char *name;
	void (*add)(rig *r);
} solve_scene;

enum { SOLVE_SCENES = 6 };
extern const solve_scene solve_scenes[SOLVE_SCENES];

// Computes x = A^-1 b (n x 3 by vertex) by the factor in double. Fixed vertices get 0.
void solve_by_factor(rig *r, const double *b, double *x);
// Computes x = A^-1 b by the packed sweeps.
void solve_by_sweep(rig *r, const double *b, double *x);
// Computes A of the live elements as a dense matrix, by vertices (n x n). Rows and columns of
// pinned vertices are 0.
void solve_dense_matrix(const rig *r, double *a);

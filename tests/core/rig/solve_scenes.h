// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes of systems that the solver must serve.
#pragma once

#include "core/rig/rig.h"

typedef struct solve_scene {
	const char *name;
	void (*add)(rig *r);
} solve_scene;

enum { SOLVE_SCENES = 6 };
extern const solve_scene solve_scenes[SOLVE_SCENES];

// x = A^-1 b (n x 3 by vertex) through the factor in double; fixed rows come out zero.
void solve_by_factor(rig *r, const double *b, double *x);
// The same through the packed sweeps.
void solve_by_sweep(rig *r, const double *b, double *x);
// Live A, dense: by vertices, (n x n), pinned rows and columns zero.
void solve_dense_matrix(const rig *r, double *a);

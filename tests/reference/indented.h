// SPDX-License-Identifier: GPL-3.0-or-later
// A body of linear tetrahedra, stable neo-Hookean or StVK, with a rigid ball pressed into it. The
// static equilibrium is found by Newton's method with the exact Hessian and an active set, in
// double. This solver is an oracle that shares nothing with core: energy, system, contact and
// convergence are computed here.
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct cau_indented_body {
	int32_t vertex_count, tetrahedron_count, surface_count;
	const double *rest;         // m, (n x 3)
	const int32_t *tetrahedron; // (m x 4), of positive volume
	const int32_t *surface;     // vertices that the ball may touch; a vertex may be listed twice
	// (face_count x 3): faces that the ball may touch between their vertices
	int32_t face_count;
	const int32_t *face;
	const bool *fixed; // (n): fixed vertices
	int model;         // CAU_MODEL_NEOHOOKEAN or CAU_MODEL_STVK
	double young_modulus_pa, poisson_ratio;
} cau_indented_body;

typedef struct cau_indenting_ball {
	double centre_m[3], radius_m;
	double dip_m; // largest depth of a face inside the ball between its vertices; the vertices stay
	              // outside
} cau_indenting_ball;

typedef struct cau_indented {
	double force_n[3]; // force on the ball
	double residual;   // largest unbalanced force on a vertex, relative to the ball's force
	double deepest_m;  // largest depth of a point that must stay outside
	int points;        // number of pushing points
	int iterations;
} cau_indented;

// Starts from `position` (m, n x 3) and finds the equilibrium. Returns false if the iterations do
// not converge. There is no friction. Call it after the program's first session is created, because
// that session chooses CHOLMOD's memory functions.
bool cau_indented_solve(const cau_indented_body *body, const cau_indenting_ball *ball,
                        double *position, cau_indented *out);

// Returns the force (N) of a rigid ball on a layer that is bonded to rigid ground, for small
// strains. It is Hertz's force with the correction of Dimitriadis, Horkay, Maresca, Kachar and
// Chadwick, "Determination of elastic moduli of thin layers of soft material using the atomic force
// microscope", Biophysical Journal 82 (2002), 2798-2810. Its last term is the fourth power of
// sqrt(radius depth) / thickness. The paper's number for nu = 0.5 has the opposite sign of its
// general formula there. The difference is 0.6 % of the force if sqrt(radius depth) / thickness is
// 0.5.
double cau_indented_by_hertz(double young_modulus_pa, double poisson_ratio, double radius_m,
                             double depth_m, double thickness_m);

// SPDX-License-Identifier: GPL-3.0-or-later
// A body of linear tetrahedra, stable neo-Hookean or StVK, into which a rigid ball is pressed: its
// static equilibrium by Newton's method with the exact Hessian and an active set, in double. An
// oracle apart from core: its energy, its system, its contact and its convergence are its own.
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct cau_indented_body {
	int32_t vertex_count, tetrahedron_count, surface_count;
	const double *rest;         // m, (n x 3)
	const int32_t *tetrahedron; // (m x 4), of positive volume
	const int32_t *surface;     // vertices that the ball may meet; one may stand there again
	int32_t face_count;         // (face_count x 3): where it may meet what is between them
	const int32_t *face;
	const bool *fixed; // (n): these stay where they are
	int model;         // CAU_MODEL_NEOHOOKEAN or CAU_MODEL_STVK
	double young_modulus_pa, poisson_ratio;
} cau_indented_body;

typedef struct cau_indenting_ball {
	double centre_m[3], radius_m;
	double dip_m; // vertices stay outside; between them a face may be so much inside
} cau_indenting_ball;

typedef struct cau_indented {
	double force_n[3]; // on the ball
	double residual;   // largest force that is left on a vertex, of the ball's
	double deepest_m;  // how far a point that is to stay outside is inside
	int points;        // that push
	int iterations;
} cau_indented;

// From `position` (m, n x 3) on, to where nothing moves it; false where it finds no such place
// within its iterations. CHOLMOD's memory is chosen by the program's first session, so it comes
// after that. No friction.
bool cau_indented_solve(const cau_indented_body *body, const cau_indenting_ball *ball,
                        double *position, cau_indented *out);

// The force (N) of a rigid ball on a layer that is bonded to a rigid ground, for small strains:
// Hertz's, with the correction of Dimitriadis, Horkay, Maresca, Kachar and Chadwick, "Determination
// of elastic moduli of thin layers of soft material using the atomic force microscope", Biophysical
// Journal 82 (2002), 2798-2810. Its last term is of the fourth power of sqrt(radius depth) /
// thickness; the paper's number for nu = 0.5 has the other sign there than its general formula,
// which is 0.6 % of the force where that ratio is 0.5.
double cau_indented_by_hertz(double young_modulus_pa, double poisson_ratio, double radius_m,
                             double depth_m, double thickness_m);

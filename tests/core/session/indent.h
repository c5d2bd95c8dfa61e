// SPDX-License-Identifier: GPL-3.0-or-later
// A ball pressed without friction into a slab that is bonded to its floor. Sessions come to rest,
// and the reference computes its own solution on the same mesh (tests/reference/indented.h). The
// slab is a grid with equal cells around the ball, from which cells grow outward and downward. So
// cells can be fine where the ball presses.
#pragma once

#include "core/session/stage.h"
#include "reference/indented.h"

typedef struct indent {
	double radius_m, depth_m;
	// Size of equal cells; distance from the middle, and depth, up to which cells are equal.
	double cell_m, even_m;
	double thick_m, half_m; // thickness of the slab; half its width
	double poisson_ratio;
} indent;

typedef struct indent_stand {
	indent of;
	char *text; // the mesh as text, for the scene
	double *rest;
	int32_t *tetrahedron, *face;
	bool *fixed;
	cau_indented_body body;
	cau_scene_def *scene;
	cau_session *session;
} indent_stand;

extern const double indent_young_modulus_pa;

// Returns how deep, m, the core lets a face be inside a ball at rest.
double indent_dip_m(double radius_m);

// Returns the number of cells across the contact patch that a ball of this size and depth has by
// Hertz.
double indent_cells(const indent *of);

indent_stand *indent_open(const indent *of);
void indent_close(indent_stand *stand);

// Moves the ball to a position (m) and the depth, and steps until everything is at rest. Returns
// the force (N) that pushes the ball up.
double indent_press(indent_stand *stand, double x_m, double y_m, double depth_m);

// Returns the reference's solution for the ball's present position. It starts from the session's
// state, or from rest with a ball that comes down in stages. Vertices stay outside the ball, and no
// point of a face is deeper than the core permits. Fails the test if there is no solution.
cau_indented indent_solve(const indent_stand *stand, bool from_rest);

// Returns how deep the deepest point of a face is inside the ball, m.
double indent_face_depth_m(const indent_stand *stand);

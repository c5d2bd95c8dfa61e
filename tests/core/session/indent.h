// SPDX-License-Identifier: GPL-3.0-or-later
// A ball pressed into a slab that is bonded to its floor, without friction: sessions at rest, and
// the same mesh for the reference's own solution (tests/reference/indented.h). The slab is a grid
// of equal cells about the ball, of which cells grow outwards and downwards, so that fine ones can
// be had where they matter.
#pragma once

#include "core/session/stage.h"
#include "reference/indented.h"

typedef struct indent {
	double radius_m, depth_m;
	double cell_m, even_m;  // equal cells as far as this from the middle, and as deep
	double thick_m, half_m; // the slab's, and its half width
	double poisson_ratio;
} indent;

typedef struct indent_stand {
	indent of;
	char *text; // the mesh, for the scene
	double *rest;
	int32_t *tetrahedron, *face;
	bool *fixed;
	cau_indented_body body;
	cau_scene_def *scene;
	cau_session *session;
} indent_stand;

extern const double indent_young_modulus_pa;

// How deep (m) core lets faces stand in a ball at rest.
double indent_dip_m(double radius_m);

// How many cells the patch spans that a ball of this size and depth has by Hertz.
double indent_cells(const indent *of);

indent_stand *indent_open(const indent *of);
void indent_close(indent_stand *stand);

// Leads the ball to a place (m) and the depth, and steps until all is at rest. Returns the force
// (N) that pushes it up.
double indent_press(indent_stand *stand, double x_m, double y_m, double depth_m);

// The reference's solution with the ball where it is now, from the session's state on or from rest,
// by a ball that comes down in stages. Vertices stay outside, and no point of a face is deeper than
// core lets it stand. Fails the test if there is none.
cau_indented indent_solve(const indent_stand *stand, bool from_rest);

// How much deeper than the ball's surface the deepest point of a face is, m.
double indent_face_depth_m(const indent_stand *stand);

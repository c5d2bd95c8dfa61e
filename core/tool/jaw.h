// SPDX-License-Identifier: GPL-3.0-or-later
// One jaw that turns about a hinge on the z axis, and its rounded plates. Private to this room.
// A jaw's own frame: hinge at the origin, the jaw along -z, its body on the side of +x, whatever
// side of the tool it is on.
#pragma once

#include <stdbool.h>

#include "tool/family.h"

typedef struct cau_jaw {
	double side;   // +1: on the tool's +x side, -1: mirrored
	double hinge;  // m, z of the hinge in the tool's frame
	double cosine; // of the angle by which it is open
	double sine;
} cau_jaw;

// A plate of the jaw: least and most corner in the jaw's frame (m), and its rounding.
typedef struct cau_plate {
	cau_vec3 least, most;
	double rounding;
} cau_plate;

cau_jaw cau_jaw_of(double side, double hinge, double angle_rad);

// Its mirror image on the other side of the tool.
cau_jaw cau_jaw_opposite(const cau_jaw *jaw);

// A plate with |y| <= half_width; its corners are moved so that it is nowhere thinner than its
// rounding.
cau_plate cau_plate_of(double x_least, double x_most, double half_width, double z_least,
                       double z_most, double rounding);

cau_vec3 cau_jaw_to_own(const cau_jaw *jaw, cau_vec3 point);

double cau_jaw_plate_distance(const cau_jaw *jaw, const cau_plate *plate, cau_vec3 point,
                              cau_vec3 *gradient);

// A ball about `center_z` on the tool's axis, below the hinge, that holds the plate at every angle
// from 0 to angle_rad.
cau_ball cau_jaw_plate_bound(double hinge, double angle_rad, const cau_plate *plate,
                             double center_z);

// Whether `point` (tool frame) lies between the faces x = face of two jaws, or less than `depth`
// inside one of them, not beyond half_width in y nor below `reach` under the hinge. *coordinate: -1
// at `low`, +1 at `high`; gaps narrower than depth are measured as that.
bool cau_jaws_hold(const cau_jaw *low, double low_face, const cau_jaw *high, double high_face,
                   double half_width, double reach, double depth, cau_vec3 point,
                   double *coordinate);

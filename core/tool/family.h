// SPDX-License-Identifier: GPL-3.0-or-later
// The functions that every family of tools provides, and the parts that several shapes have.
// Private to core/tool.
#pragma once

#include <stdbool.h>

#include "tool/tool_shape.h"

typedef struct cau_ball {
	cau_vec3 center;
	double radius_m;
} cau_ball;

typedef double (*cau_part_distance)(const cau_tool_def *tool, double jaw, cau_vec3 point,
                                    cau_vec3 *gradient);

typedef struct cau_tool_family {
	cau_part_distance hot; // NULL: the shape has no hot part
	cau_part_distance cold;
	cau_ball (*hot_bound)(const cau_tool_def *tool); // a ball that contains the part at every jaw
	                                                 // angle; NULL if `hot` is NULL
	cau_ball (*cold_bound)(const cau_tool_def *tool);
	double (*thinnest_hot)(const cau_tool_def *tool); // radius, m; NULL if `hot` is NULL
	// NULL: the shape has no jaws.
	bool (*between)(const cau_tool_def *tool, double jaw, cau_vec3 point, double *jaw_coordinate);
	cau_tool_jaws (*jaws)(const cau_tool_def *tool); // NULL if `between` is NULL
} cau_tool_family;

// Functions of every family, named cau_shape_<word>: one family for each row of the table. They are
// defined in the shape's file.
#define X(code, word, ...) extern const cau_tool_family cau_shape_##word;
CAU_TOOL_SHAPE_TABLE(X)
#undef X

// Returns the distance to the cold shaft: a capsule about the z axis, whose lowest point is at z =
// start.
double cau_shaft_distance(const cau_tool_def *tool, double start, cau_vec3 point,
                          cau_vec3 *gradient);
cau_ball cau_shaft_bound(const cau_tool_def *tool, double start);

// Returns the smallest ball that contains two balls.
cau_ball cau_ball_join(cau_ball a, cau_ball b);

// Returns half the thickness of a blade or jaw whose half width is `half_width`.
static inline double cau_blade_half_thickness(double half_width)
{
	return 0.4 * half_width;
}

// ---- jaws
// A jaw turns about a hinge on the z axis, and has rounded plates. A jaw's own frame has the hinge
// at the origin and the jaw along -z. The jaw's body is on the side of +x, whichever side of the
// tool the jaw is on.
typedef struct cau_jaw {
	double side;   // +1: on the tool's +x side, -1: mirrored
	double hinge;  // m, z of the hinge in the tool's frame
	double cosine; // cosine of the opening angle
	double sine;
} cau_jaw;

// A plate of the jaw: its least and greatest corner in the jaw's frame (m), and its rounding.
typedef struct cau_plate {
	cau_vec3 least, most;
	double rounding;
} cau_plate;

cau_jaw cau_jaw_of(double side, double hinge, double angle_rad);

// Returns the mirror image of a jaw: the jaw on the other side of the tool.
cau_jaw cau_jaw_opposite(const cau_jaw *jaw);

// Returns a plate with |y| <= half_width. The plate is nowhere thinner than its rounding: its
// corners are moved if needed.
cau_plate cau_plate_of(double x_least, double x_most, double half_width, double z_least,
                       double z_most, double rounding);

cau_vec3 cau_jaw_to_own(const cau_jaw *jaw, cau_vec3 point);

double cau_jaw_plate_distance(const cau_jaw *jaw, const cau_plate *plate, cau_vec3 point,
                              cau_vec3 *gradient);

// Returns a ball about the point z = center_z on the tool's axis, below the hinge. The ball
// contains the plate at every angle from 0 to angle_rad.
cau_ball cau_jaw_plate_bound(double hinge, double angle_rad, const cau_plate *plate,
                             double center_z);

// True if `point` (tool frame) is between the faces x = low_face and x = high_face of two jaws, or
// less than `depth` inside one of them. The point must be within half_width in y, below the hinge,
// and at most `reach` below the hinge. *coordinate is -1 at `low` and +1 at `high`. A gap narrower
// than `depth` is taken to be `depth` wide.
bool cau_jaws_hold(const cau_jaw *low, double low_face, const cau_jaw *high, double high_face,
                   double half_width, double reach, double depth, cau_vec3 point,
                   double *coordinate);

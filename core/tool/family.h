// SPDX-License-Identifier: GPL-3.0-or-later
// The functions that every family of tools provides. Private to core/tool. Each family has its own
// file.
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
// defined in the shape's own file.
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

// SPDX-License-Identifier: GPL-3.0-or-later
// What every family of tools must offer; private to this room. One file per family.
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
	cau_ball (*hot_bound)(const cau_tool_def *tool); // for every jaw angle; NULL as `hot`
	cau_ball (*cold_bound)(const cau_tool_def *tool);
	double (*thinnest_hot)(const cau_tool_def *tool); // m; NULL as `hot`
	// NULL: the shape has no jaws.
	bool (*between)(const cau_tool_def *tool, double jaw, cau_vec3 point, double *jaw_coordinate);
	cau_tool_jaws (*jaws)(const cau_tool_def *tool); // NULL as `between`
} cau_tool_family;

// cau_shape_sphere and so on: one of each row of the table, defined in the shape's own file.
#define X(code, word, ...) extern const cau_tool_family cau_shape_##word;
CAU_TOOL_SHAPE_TABLE(X)
#undef X

// The cold shaft: a capsule about the z axis whose lowest point is at z = start.
double cau_shaft_distance(const cau_tool_def *tool, double start, cau_vec3 point,
                          cau_vec3 *gradient);
cau_ball cau_shaft_bound(const cau_tool_def *tool, double start);

// The smallest ball around two balls.
cau_ball cau_ball_join(cau_ball a, cau_ball b);

// Half the thickness of a blade or jaw whose half width is `half_width`.
static inline double cau_blade_half_thickness(double half_width)
{
	return 0.4 * half_width;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// How near a tool comes to a triangle, and where.
#pragma once

#include "tool/tool_shape.h"

// The point of triangle a, b, c that is nearest to `point`, as three weights >= 0 of sum 1
// (C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
void cau_nearest_on_triangle(cau_vec3 point, const cau_vec3 corner[3], double weight[3]);

// The least signed distance (m) of the tool's part over a triangle in the tool's frame, and in
// `weight` where it is: found downhill from the `weight` that is given (projected gradient, each
// step to the triangle's point nearest to the tool's inside), so that a tool with several arms has
// as many answers. `gradient` (unit, outward) is the distance's there.
double cau_tool_face_distance(const cau_tool_def *tool, double jaw, cau_tool_part part,
                              const cau_vec3 corner[3], double weight[3], cau_vec3 *gradient);

// The surface's height (m) above `point`, both in the tool's frame, along the unit vector `out`:
// how far a point has to go that way to be outside for good, of `most_m` at most; 0 if it is.
// `gradient` is the distance's where it comes out.
double cau_tool_way_out(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 point,
                        cau_vec3 out, double most_m, cau_vec3 *gradient);

// SPDX-License-Identifier: GPL-3.0-or-later
// The distance between a tool and a triangle, and where on the triangle it is.
#pragma once

#include "tool/tool_shape.h"

// Finds the point of a triangle that is nearest to `point`, as three weights >= 0 of sum 1 (C.
// Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
void cau_nearest_on_triangle(cau_vec3 point, const cau_vec3 corner[3], double weight[3]);

// Returns the least signed distance (m) of the tool's part over a triangle in the tool's frame.
// `weight` is the start of the search on entry and the nearest point on return. The search goes
// downhill from the start: by projected gradient, where each step goes to the triangle's point that
// is nearest to a point inside the tool. So a tool with several arms has a result for each arm.
// `gradient` (unit, outward) is the gradient of the distance at the result.
double cau_tool_face_distance(const cau_tool_def *tool, double jaw, cau_tool_part part,
                              const cau_vec3 corner[3], double weight[3], cau_vec3 *gradient);

// Returns how far (m) `point` has to move along the unit vector `out` to leave the part and not
// meet it again. Both vectors are in the tool's frame. Returns at most `most_m`, and 0 if nothing
// of the part is in the way. `gradient` is the gradient of the distance where the point leaves the
// part.
double cau_tool_way_out(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 point,
                        cau_vec3 out, double most_m, cau_vec3 *gradient);

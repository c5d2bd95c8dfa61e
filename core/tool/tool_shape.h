// SPDX-License-Identifier: GPL-3.0-or-later
// Tool shapes as signed distances with gradients. Each shape has hot and cold parts (section 6.2).
#pragma once

#include <stdbool.h>

#include "base/vector.h"
#include "cautery/scene.h"

typedef enum cau_tool_part {
	CAU_PART_HOT,  // heats while energy is on, and drags; pushes only while energy is off
	CAU_PART_COLD, // always pushes
	CAU_PART_BOTH, // hot and cold part together: the nearer one counts
} cau_tool_part;

// Returns the signed distance (m) to the part's surface at `point` in the tool's frame: tip at the
// origin, shaft along +z, jaws open in x. The distance is negative inside and 1-Lipschitz, so it
// may be sphere-traced. If the shape has no such part, the distance is INFINITY. `jaw` is 0 for
// closed jaws to 1 for open jaws. `gradient` (unit, outward; may be NULL) is the direction away
// from the nearest surface point. If several surface points are equally near, it is the direction
// from one of them.
double cau_tool_distance(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 point,
                         cau_vec3 *gradient);

// Returns the same distance for a point and a gradient in the world's frame.
double cau_tool_distance_at(const cau_tool_def *tool, const cau_pose *pose, double jaw,
                            cau_tool_part part, cau_vec3 point, cau_vec3 *gradient);

// Finds a sphere (tool frame) that contains the whole part at every jaw angle. The radius is 0 if
// the shape has no such part.
void cau_tool_bound(const cau_tool_def *tool, cau_tool_part part, cau_vec3 *center,
                    double *radius_m);

// Returns the thinnest radius of the hot part (m). The heat grid's step must not exceed it.
// INFINITY if the shape has no hot part.
double cau_tool_thinnest_hot_m(const cau_tool_def *tool);

// True if the shape has jaws that can grasp.
bool cau_tool_has_jaws(const cau_tool_def *tool);

// True if `point` (tool frame) is between the jaws, where the jaws can grasp it. False if the shape
// has no jaws. The space between the jaws includes points less than half a jaw's thickness inside a
// jaw, so that closed jaws hold the pressed tissue. On success *jaw_coordinate (may be NULL) is -1
// at one jaw and +1 at the other jaw.
bool cau_tool_between_jaws(const cau_tool_def *tool, double jaw, cau_vec3 point,
                           double *jaw_coordinate);

// Describes how the jaws turn: about the y axis through z = hinge_m. Closed jaws meet in the plane
// x = face_m. The jaw on the side of -x turns by share[0] of the opening angle, the jaw on the side
// of +x by share[1].
typedef struct cau_tool_jaws {
	double hinge_m, face_m;
	double share[2];
} cau_tool_jaws;

// Returns how the jaws turn. The shape must have jaws.
cau_tool_jaws cau_tool_describe_jaws(const cau_tool_def *tool);

// Returns the opening angle (rad), from the closed plane, at which a jaw's face contains `point`
// (tool frame). Negative on the side of -x.
double cau_tool_jaw_angle(const cau_tool_jaws *jaws, cau_vec3 point);

// Returns `point` turned about the hinge to the angle `angle_rad`.
cau_vec3 cau_tool_turn_with_jaw(const cau_tool_jaws *jaws, cau_vec3 point, double angle_rad);

// True if the segment a-b (tool frame) meets the part or is inside it. The segment is sphere-traced
// from both ends. If it is closer than 1e-6 m to the part, the result is true. After 1,024 steps
// the result is also true: the segment then ran within a thousandth of its length of the surface.
bool cau_tool_meets_segment(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 a,
                            cau_vec3 b);

// ---- distances between a tool and a triangle (face_distance.c)
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

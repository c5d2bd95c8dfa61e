// SPDX-License-Identifier: GPL-3.0-or-later
// Tool shapes as signed distances with gradients, each with hot and cold parts (section 6.2).
#pragma once

#include <stdbool.h>

#include "base/vector.h"
#include "cautery/scene.h"

typedef enum cau_tool_part {
	CAU_PART_HOT,  // heats while energized, drags; pushes only while the energy is off
	CAU_PART_COLD, // always pushes
	CAU_PART_BOTH, // the nearer of the two
} cau_tool_part;

// Signed distance (m) to the part's surface at `point` in the tool's frame (tip at the origin,
// shaft along +z, jaws open in x); negative inside; 1-Lipschitz, so it may be sphere-traced. A part
// the shape lacks is at distance INFINITY. `jaw` is 0 closed to 1 open. `gradient` (unit, outward;
// may be NULL) is one of the nearest directions where several are equal.
double cau_tool_distance(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 point,
                         cau_vec3 *gradient);

// The same in the world's frame.
double cau_tool_distance_at(const cau_tool_def *tool, const cau_pose *pose, double jaw,
                            cau_tool_part part, cau_vec3 point, cau_vec3 *gradient);

// A sphere (tool frame) that holds the whole part for every jaw angle; radius 0 for a part the
// shape lacks.
void cau_tool_bound(const cau_tool_def *tool, cau_tool_part part, cau_vec3 *center,
                    double *radius_m);

// Thinnest radius of the hot part (m): the heat grid's step must not exceed it. INFINITY for a
// shape without a hot part.
double cau_tool_thinnest_hot_m(const cau_tool_def *tool);

// Whether the shape has jaws that can grasp.
bool cau_tool_has_jaws(const cau_tool_def *tool);

// Whether `point` (tool frame) lies between the jaws, where a grasp takes hold; false for a shape
// without jaws. Points less than half a jaw's thickness inside a jaw count too, so that closed jaws
// hold what they press. On success *jaw_coordinate (may be NULL) is -1 at one jaw, +1 at the other.
bool cau_tool_between_jaws(const cau_tool_def *tool, double jaw, cau_vec3 point,
                           double *jaw_coordinate);

// How the jaws turn: about the y axis through z = hinge_m, and closed they meet in the plane
// x = face_m. The one on the side of -x turns by share[0] of the opening angle, the other by
// share[1].
typedef struct cau_tool_jaws {
	double hinge_m, face_m;
	double share[2];
} cau_tool_jaws;

// Of a shape that has jaws.
cau_tool_jaws cau_tool_describe_jaws(const cau_tool_def *tool);

// The angle (rad) by which a jaw that turns from the closed plane is open when its face goes
// through `point` (tool frame); negative on the side of -x.
double cau_tool_jaw_angle(const cau_tool_jaws *jaws, cau_vec3 point);

// The point, turned about the hinge to such an angle.
cau_vec3 cau_tool_turn_with_jaw(const cau_tool_jaws *jaws, cau_vec3 point, double angle_rad);

// Whether the segment a-b (tool frame) meets or lies inside the part. Sphere-traced from both ends,
// exact to 1e-6 m: what passes nearer than that meets. After 1,024 steps the answer is that it
// meets; the segment then ran within a thousandth of its length of the surface.
bool cau_tool_meets_segment(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 a,
                            cau_vec3 b);

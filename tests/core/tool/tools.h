// SPDX-License-Identifier: GPL-3.0-or-later
// Tools, poses and random numbers for the tests of core/tool and core/heat.
#pragma once

#include "base/vector.h"

// For cmocka: asserts that two doubles differ by at most a named tolerance.
#define assert_near(value, expected, tolerance)                                                    \
	assert_true(fabs((value) - (expected)) <= (tolerance))

// Returns a tool with the defaults of the table in scene.h, at the origin, without rotation.
static inline cau_tool_def tool_with_defaults(int shape)
{
	cau_tool_def tool = {.shape = shape, .pose = {.rotation = {1, 0, 0, 0}}};
#define X(field, default_, least, most, unit, meaning) tool.field = default_;
	CAU_TOOL_TABLE(X)
#undef X
	return tool;
}

static inline cau_pose pose_at(double x, double y, double z)
{
	return (cau_pose){.position_m = {x, y, z}, .rotation = {1, 0, 0, 0}};
}

static inline cau_pose pose_turned(cau_vec3 position, cau_vec3 axis, double angle_rad)
{
	cau_vec3 u = cau_scale(sin(angle_rad / 2), cau_unit_or(axis, (cau_vec3){0, 0, 1}));
	return (cau_pose){.position_m = {position.x, position.y, position.z},
	                  .rotation = {cos(angle_rad / 2), u.x, u.y, u.z}};
}

// Returns the next number of a fixed pseudo-random sequence, uniform in [least, most), the same in
// every run (Park and Miller).
static inline double random_between(uint64_t *state, double least, double most)
{
	*state = *state * 48271 % 2147483647;
	return least + (most - least) * ((double)*state / 2147483647.0);
}

// Returns a random point in the box x, y in +-side, z in -side to 3 side.
static inline cau_vec3 random_point(uint64_t *state, double side)
{
	cau_vec3 p;
	p.x = random_between(state, -side, side);
	p.y = random_between(state, -side, side);
	p.z = random_between(state, -side, 3 * side);
	return p;
}

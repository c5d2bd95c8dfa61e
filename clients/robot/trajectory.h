// SPDX-License-Identifier: GPL-3.0-or-later
// Where the tool is to be, and when: poses in time, joined by straight lines.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct robot_pose {
	double position_m[3];
	double rotation[4]; // w, x, y, z: tool to world
} robot_pose;

typedef struct robot_waypoint {
	double time_s;
	robot_pose pose;
} robot_waypoint;

typedef struct robot_trajectory {
	robot_waypoint *waypoints; // at least one; times ascend from 0
	size_t count;
} robot_trajectory;

// False: not to be used, and why is printed on `errors`.
bool robot_trajectory_read(robot_trajectory *trajectory, const char *file, FILE *errors);
// Dwells at `from_m`, then goes to `to_m`, rotation at rest.
bool robot_trajectory_line(robot_trajectory *trajectory, const double from_m[3],
                           const double to_m[3], double dwell_s, double speed_m_s);
void robot_trajectory_finish(robot_trajectory *trajectory);
double robot_trajectory_seconds(const robot_trajectory *trajectory);
robot_pose robot_trajectory_at(const robot_trajectory *trajectory, double time_s);
// Between two poses, share 0 to 1.
robot_pose robot_pose_between(const robot_pose *a, const robot_pose *b, double share);

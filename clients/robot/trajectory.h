// SPDX-License-Identifier: GPL-3.0-or-later
// A trajectory: tool poses at given times, joined by straight lines.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct robot_pose {
	double position_m[3];
	double rotation[4]; // w, x, y, z; from tool to world
} robot_pose;

typedef struct robot_waypoint {
	double time_s;
	robot_pose pose;
} robot_waypoint;

typedef struct robot_trajectory {
	robot_waypoint *waypoints; // at least one, with times that ascend from 0
	size_t count;
} robot_trajectory;

// Reads a trajectory file. Returns false after printing the reason on `errors`; the trajectory is
// then invalid.
bool robot_trajectory_read(robot_trajectory *trajectory, const char *file, FILE *errors);
// Makes a trajectory that dwells at `from_m` and then moves to `to_m`, without rotation.
bool robot_trajectory_line(robot_trajectory *trajectory, const double from_m[3],
                           const double to_m[3], double dwell_s, double speed_m_s);
void robot_trajectory_finish(robot_trajectory *trajectory);
double robot_trajectory_seconds(const robot_trajectory *trajectory);
robot_pose robot_trajectory_at(const robot_trajectory *trajectory, double time_s);
// Interpolates between two poses; `share` is 0 to 1.
robot_pose robot_pose_between(const robot_pose *a, const robot_pose *b, double share);

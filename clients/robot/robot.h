// SPDX-License-Identifier: GPL-3.0-or-later
// Declarations for the files of cautery-robot.
#pragma once

#include <dds/dds.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "cautery.h"

// ---- options (main.c) --------------------------------------------------------------------------
// The command line of cautery-robot.
typedef struct robot_options {
	const char *session, *tool;
	const char *trajectory; // file, or NULL for the line from `from_m` to `to_m`
	double from_m[3], to_m[3];
	double speed_m_s;     // along the line, and on the approach to its start
	double dwell_s;       // wait at the start of the line
	double rate_hz;       // commands a second
	double deadline_s;    // deadline that the writer declares
	double force_limit_n; // force above which the tool retreats; 0 for no limit
	double seconds;       // time limit; 0 means until the trajectory's end
	int32_t domain;
	bool energy, standby, json, help, version;
} robot_options;

// ---- times (histogram.c) -----------------------------------------------------------------------
// A histogram of times. Each bin is a tenth wider than the previous one, from 1 us to some 100 s.
// Nothing is allocated.
enum { ROBOT_BINS = 194 };

typedef struct robot_histogram {
	uint64_t bins[ROBOT_BINS];
	uint64_t count;
	double most_s;
} robot_histogram;

void robot_histogram_add(robot_histogram *histogram, double seconds);
// Returns the time, s, that `share` of the samples do not exceed. It is the upper edge of a bin.
double robot_histogram_quantile(const robot_histogram *histogram, double share);
void robot_histogram_print(const robot_histogram *histogram, const char *name, FILE *out);

// ---- trajectory (trajectory.c) -----------------------------------------------------------------
// A trajectory: tool poses at given times, joined by straight lines.
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

// ---- DDS (link.c) ------------------------------------------------------------------------------
// The robot's DDS connection: a writer of tool commands, a reader of tool states, and a reader of
// the force in CRTK's measured_cf.
enum { ROBOT_SENT = 8192 };

typedef struct robot_link {
	dds_entity_t participant, writer, reader, force_reader, waitset;
	cautery_ToolCommand command; // last written command
	cautery_ToolState state;     // newest state
	bool has_state;
	// force of the newest measured_cf, or of the state before a measured_cf has come
	double force_n[3];
	bool has_force;            // a measured_cf has come
	char name[65];             // the server's name for this writer
	double sent_s[ROBOT_SENT]; // time of each command, at index sequence % ROBOT_SENT
	// time from writing a command to the arrival of the state that shows it
	robot_histogram latency;
} robot_link;

// Opens the connection. Returns false after printing the reason on `errors`. Call robot_link_close
// in either case.
bool robot_link_open(robot_link *link, const robot_options *options, FILE *errors);
void robot_link_close(robot_link *link);
// Waits until the server reads and its first state has come, `seconds` at most.
bool robot_link_wait(robot_link *link, double seconds);
void robot_link_read(robot_link *link);
bool robot_link_write(robot_link *link, const robot_pose *pose, bool energy);
bool robot_link_drives(const robot_link *link);
double robot_monotonic_s(void);

// ---- control loop (control.c) ------------------------------------------------------------------
// The control loop: moves to the start, follows the trajectory, and retreats if the force is too
// high.
typedef struct robot_report {
	double seconds;
	uint64_t commands;
	uint64_t missed;        // number of periods without a command
	double force_most_n;    // largest force
	double backed_off_m;    // largest retreat
	bool took_over;         // true if this program waited in standby and then became the driver
	const char *lost;       // why the loop ended early, or NULL
	char lost_text[128];    // text of `lost`, if the text has a name
	robot_histogram jitter; // how late the loop woke
} robot_report;

// Runs until the trajectory or `seconds` are over, the tool is lost, or *stop is set. Prints
// `drives` to standard output when this program becomes the tool's driver.
void robot_control(robot_link *link, const robot_options *options,
                   const robot_trajectory *trajectory, const volatile int *stop,
                   robot_report *report);

// SPDX-License-Identifier: GPL-3.0-or-later
// The robot's DDS connection: a writer of tool commands, a reader of tool states, and a reader of
// the force in CRTK's measured_cf.
#pragma once

#include <dds/dds.h>

#include "cautery.h"
#include "robot/histogram.h"
#include "robot/options.h"
#include "robot/trajectory.h"

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

// SPDX-License-Identifier: GPL-3.0-or-later
// The robot's side of the wire: a writer of tool commands, readers of tool states and of the force
// that CRTK's measured_cf tells.
#pragma once

#include <dds/dds.h>

#include "cautery.h"
#include "robot/histogram.h"
#include "robot/options.h"
#include "robot/trajectory.h"

enum { ROBOT_SENT = 8192 };

typedef struct robot_link {
	dds_entity_t participant, writer, reader, force_reader, waitset;
	cautery_ToolCommand command; // the last one written
	cautery_ToolState state;     // the newest
	bool has_state;
	double force_n[3];         // the newest measured_cf; the state's where there is none
	bool has_force;            // measured_cf has come
	char name[65];             // as the server calls this writer
	double sent_s[ROBOT_SENT]; // by sequence number modulo ROBOT_SENT
	robot_histogram latency;   // from writing the command that a state shows to its coming
} robot_link;

// False: why is printed on `errors`. robot_link_close in either case.
bool robot_link_open(robot_link *link, const robot_options *options, FILE *errors);
void robot_link_close(robot_link *link);
// Waits until the server reads and its first state has come, at most `seconds`.
bool robot_link_wait(robot_link *link, double seconds);
void robot_link_read(robot_link *link);
bool robot_link_write(robot_link *link, const robot_pose *pose, bool energy);
bool robot_link_drives(const robot_link *link);
double robot_monotonic_s(void);

// SPDX-License-Identifier: GPL-3.0-or-later
// The robot's side of the wire: one writer of tool commands, one reader of tool states.
#pragma once

#include <dds/dds.h>

#include "cautery.h"
#include "robot/histogram.h"
#include "robot/options.h"
#include "robot/trajectory.h"

enum { ROBOT_SENT = 8192 };

typedef struct robot_link {
	dds_entity_t participant, writer, reader, waitset;
	cautery_ToolCommand command; // the last one written
	cautery_ToolState state;     // the newest
	bool has_state;
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

// SPDX-License-Identifier: GPL-3.0-or-later
// The control loop: to the start, along the trajectory, away from too much force.
#pragma once

#include "robot/link.h"

typedef struct robot_report {
	double seconds;
	uint64_t commands;
	uint64_t missed;        // periods that passed without a command
	double force_most_n;    // seen
	double backed_off_m;    // the most
	bool took_over;         // standby: drove in the end
	const char *lost;       // why it gave up, or NULL
	robot_histogram jitter; // how late it woke
} robot_report;

// Runs until the trajectory or `seconds` are over, the tool is lost, or *stop is set.
// Prints `drives` to standard output when the tool becomes its own.
void robot_control(robot_link *link, const robot_options *options,
                   const robot_trajectory *trajectory, const volatile int *stop,
                   robot_report *report);

// SPDX-License-Identifier: GPL-3.0-or-later
// The control loop: moves to the start, follows the trajectory, and retreats if the force is too
// high.
#pragma once

#include "robot/link.h"

typedef struct robot_report {
	double seconds;
	uint64_t commands;
	uint64_t missed;        // number of periods without a command
	double force_most_n;    // largest force
	double backed_off_m;    // largest retreat
	bool took_over;         // true if this program waited in standby and then became the driver
	const char *lost;       // why the loop ended early, or NULL
	robot_histogram jitter; // how late the loop woke
} robot_report;

// Runs until the trajectory or `seconds` are over, the tool is lost, or *stop is set. Prints
// `drives` to standard output when this program becomes the tool's driver.
void robot_control(robot_link *link, const robot_options *options,
                   const robot_trajectory *trajectory, const volatile int *stop,
                   robot_report *report);

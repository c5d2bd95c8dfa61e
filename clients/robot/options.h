// SPDX-License-Identifier: GPL-3.0-or-later
// What cautery-robot is asked on its command line.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct robot_options {
	const char *session, *tool;
	const char *trajectory; // file, or NULL: the line from `from_m` to `to_m`
	double from_m[3], to_m[3];
	double speed_m_s;     // along the line, and on the way to the start
	double dwell_s;       // at the start of the line
	double rate_hz;       // of commands
	double deadline_s;    // declared
	double force_limit_n; // backs off above; 0: never
	double seconds;       // ends after this; 0: with the trajectory
	int32_t domain;
	bool energy, standby, json, help, version;
} robot_options;

// False: *options is not to be used, and why is printed on `errors`.
bool robot_options_read(robot_options *options, int argument_count, char **arguments, FILE *errors);
void robot_options_help(FILE *out);

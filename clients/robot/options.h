// SPDX-License-Identifier: GPL-3.0-or-later
// The command line of cautery-robot.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

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

// Reads the command line. Returns false after printing the reason on `errors`; *options is then
// invalid.
bool robot_options_read(robot_options *options, int argument_count, char **arguments, FILE *errors);
void robot_options_help(FILE *out);

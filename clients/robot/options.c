// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/options.h"

#include <math.h>

#include "cautery/options.h"

#define AT(member) offsetof(robot_options, member)

static const cau_option rows[] = {
	{"trajectory", "FILE", CAU_OPTION_TEXT, AT(trajectory),
     .meaning = "file with lines `T X Y Z [W QX QY QZ]` (s, m, quaternion); without it a line:"},
	{"from", "X,Y,Z", CAU_OPTION_POINT, AT(from_m),
     .meaning = "start of the line, m (default 0,0,0.02)"},
	{"to", "X,Y,Z", CAU_OPTION_POINT, AT(to_m),
     .meaning = "end of the line, m (default: the start of the line)"},
	{"dwell", "S", CAU_OPTION_NUMBER, AT(dwell_s), 0, 3600,
     .meaning = "seconds to stay at the start of the line (default 0)"},
	{"speed", "V", CAU_OPTION_NUMBER, AT(speed_m_s), 1e-4, 1,
     .meaning = "speed on the line and on the way to its start, m/s (default 0.02)"},
	{"energy", NULL, CAU_OPTION_FLAG, AT(energy), .meaning = "turn energy on along the trajectory"},
	{"force-limit", "N", CAU_OPTION_NUMBER, AT(force_limit_n), 0, 1000,
     .meaning = "force above which the tool retreats along its shaft (default 0: never)"},
	{"rate", "HZ", CAU_OPTION_NUMBER, AT(rate_hz), 1, 5000,
     .meaning = "commands in a second (default 1000)"},
	{"deadline", "S", CAU_OPTION_NUMBER, AT(deadline_s), 0.02, 1,
     .meaning = "silence after which the server turns energy off, s (default 0.05)"},
	{"seconds", "S", CAU_OPTION_NUMBER, AT(seconds), 0, 1e6,
     .meaning = "time after which the program ends, s (default: at the end of the trajectory)"},
	{"standby", NULL, CAU_OPTION_FLAG, AT(standby),
     .meaning = "wait, and hold the tool when its driver is gone or silent; never energize"},
	{"domain", "N", CAU_OPTION_WHOLE, AT(domain), 0, 230,
     .meaning = "DDS domain (default 0); CYCLONEDDS_URI configures Cyclone DDS"},
	{"json", NULL, CAU_OPTION_FLAG, AT(json), .meaning = "print one JSON object as the last line"},
	{"help", NULL, CAU_OPTION_HELP, AT(help), .meaning = "print this text"},
	{"version", NULL, CAU_OPTION_HELP, AT(version), .meaning = "print the version of this program"},
};

static const cau_command_line line = {
	.program = "cautery-robot",
	.words = "SESSION TOOL",
	.word_count = 2,
	.summary =
		"Drives a tool over DDS along a trajectory or a line. Prints how late its loop woke, and\n"
		"how long each command took to appear in the state of the tool.\n",
	.closing =
		"Exit code: 0 done; 1 the tool was refused or lost; 2 wrong options; 3 no such tool.\n",
	.rows = rows,
	.row_count = sizeof rows / sizeof *rows,
};

void robot_options_help(FILE *out)
{
	cau_options_help(&line, out);
}

bool robot_options_read(robot_options *options, int argument_count, char **arguments, FILE *errors)
{
	const char *words[2] = {NULL, NULL};
	*options = (robot_options){.from_m = {0, 0, 0.02},
	                           .to_m = {NAN, NAN, NAN},
	                           .speed_m_s = 0.02,
	                           .rate_hz = 1000,
	                           .deadline_s = 0.05};
	if (!cau_options_read(&line, argument_count, arguments, options, words, errors))
		return false;
	options->session = words[0];
	options->tool = words[1];
	for (int i = 0; i < 3; i++)
		if (isnan(options->to_m[i]))
			options->to_m[i] = options->from_m[i];
	return true;
}

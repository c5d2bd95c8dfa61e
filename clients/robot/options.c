// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/options.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>

static const struct option long_options[] = {
	{"trajectory", required_argument, NULL, 't'},
	{"from", required_argument, NULL, 'f'},
	{"to", required_argument, NULL, 'o'},
	{"speed", required_argument, NULL, 'v'},
	{"dwell", required_argument, NULL, 'w'},
	{"rate", required_argument, NULL, 'r'},
	{"deadline", required_argument, NULL, 'd'},
	{"force-limit", required_argument, NULL, 'l'},
	{"seconds", required_argument, NULL, 's'},
	{"domain", required_argument, NULL, 'n'},
	{"energy", no_argument, NULL, 'e'},
	{"standby", no_argument, NULL, 'b'},
	{"json", no_argument, NULL, 'j'},
	{"help", no_argument, NULL, 'h'},
	{NULL, 0, NULL, 0},
};

void robot_options_help(FILE *out)
{
	fputs(
		"cautery-robot [options] SESSION TOOL\n"
		"Drives a tool over DDS: along a trajectory, or along a line; prints how late it woke and\n"
		"how long each command took to show in the tool's state.\n"
		"\n"
		"  --trajectory FILE  lines `T X Y Z [W QX QY QZ]`: s, m, tool to world; else\n"
		"  --from X,Y,Z       m: start of the line (default 0,0,0.02)\n"
		"  --to X,Y,Z         m: its end (default: its start)\n"
		"  --dwell S          at the start of the line (default 0)\n"
		"  --speed V          m/s, on the line and to the start (default 0.02)\n"
		"  --energy           energy on while on the trajectory\n"
		"  --force-limit N    backs off along the shaft above this force (default 0: never)\n"
		"  --rate HZ          commands a second (default 1000)\n"
		"  --deadline S       declared to the server (default 0.05)\n"
		"  --seconds S        ends after this (default: with the trajectory)\n"
		"  --standby          holds the tool once its driver is gone or silent; never energizes\n"
		"  --domain N         DDS domain (default 0); CYCLONEDDS_URI configures Cyclone DDS\n"
		"  --json             one JSON object as the last line of output\n"
		"\n"
		"Exit code: 0 done; 1 refused or lost the tool; 2 options; 3 no such tool on the wire.\n",
		out);
}

static bool read_point(double point[3], const char *text)
{
	for (int i = 0; i < 3; i++) {
		char *end;
		point[i] = strtod(text, &end);
		if (end == text || *end != (i < 2 ? ',' : 0) || !isfinite(point[i]))
			return false;
		text = end + 1;
	}
	return true;
}

static bool read_number(double *value, const char *text, double least, double most)
{
	char *end;
	*value = strtod(text, &end);
	return end != text && !*end && *value >= least && *value <= most;
}

static bool read_option(robot_options *options, int option, const char *text)
{
	double number = 0;
	switch (option) {
	case 't':
		options->trajectory = text;
		return true;
	case 'f':
		return read_point(options->from_m, text);
	case 'o':
		return read_point(options->to_m, text);
	case 'v':
		return read_number(&options->speed_m_s, text, 1e-4, 1);
	case 'w':
		return read_number(&options->dwell_s, text, 0, 3600);
	case 'r':
		return read_number(&options->rate_hz, text, 1, 5000);
	case 'd':
		return read_number(&options->deadline_s, text, 0.02, 1);
	case 'l':
		return read_number(&options->force_limit_n, text, 0, 1000);
	case 's':
		return read_number(&options->seconds, text, 0, 1e6);
	case 'n':
		if (!read_number(&number, text, 0, 230))
			return false;
		options->domain = (uint32_t)number;
		return true;
	default:
		options->energy = options->energy || option == 'e';
		options->standby = options->standby || option == 'b';
		options->json = options->json || option == 'j';
		options->help = options->help || option == 'h';
		return option != '?';
	}
}

bool robot_options_read(robot_options *options, int argument_count, char **arguments, FILE *errors)
{
	*options = (robot_options){.from_m = {0, 0, 0.02},
	                           .to_m = {NAN, NAN, NAN},
	                           .speed_m_s = 0.02,
	                           .rate_hz = 1000,
	                           .deadline_s = 0.05};
	for (int option;
	     (option = getopt_long(argument_count, arguments, "", long_options, NULL)) != -1;)
		if (!read_option(options, option, optarg)) {
			if (option != '?')
				fprintf(errors, "cautery-robot: `%s` is not within its range\n", optarg);
			return false;
		}
	if (options->help)
		return true;
	if (argument_count - optind != 2) {
		fprintf(errors, "cautery-robot: needs SESSION and TOOL; see --help\n");
		return false;
	}
	options->session = arguments[optind];
	options->tool = arguments[optind + 1];
	for (int i = 0; i < 3; i++)
		if (isnan(options->to_m[i]))
			options->to_m[i] = options->from_m[i];
	return true;
}

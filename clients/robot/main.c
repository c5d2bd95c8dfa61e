// SPDX-License-Identifier: GPL-3.0-or-later
// cautery-robot: a robot controller on DDS, as an example and for tests.
#include <math.h>
#include <signal.h>
#include <stdlib.h>

#include "cautery/options.h"
#include "robot/robot.h"

// ---- options -----------------------------------------------------------------------------------
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

static void print_help(FILE *out)
{
	cau_options_help(&line, out);
}

// Reads the command line. Returns false after printing the reason on `errors`; *options is then
// invalid.
static bool read_options(robot_options *options, int argument_count, char **arguments, FILE *errors)
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

// ---- the program -------------------------------------------------------------------------------
#define WAIT_S 10 // timeout for the session's topics

enum { EXIT_DONE, EXIT_LOST, EXIT_USAGE, EXIT_NO_TOOL };

static volatile int stop;

static void on_signal(int signal_number)
{
	(void)signal_number;
	stop = 1;
}

static void print_json_text(const char *text)
{
	putchar('"');
	for (; *text; text++)
		if (*text == '"' || *text == '\\')
			printf("\\%c", *text);
		else if ((unsigned char)*text < 0x20)
			printf("\\u%04x", (unsigned)*text);
		else
			putchar(*text);
	putchar('"');
}

static void print_json(const robot_report *report, const robot_link *link)
{
	printf("{\"seconds\": %.3f, \"commands\": %llu, \"missed\": %llu, "
	       "\"jitter_p50_s\": %.6f, \"jitter_p99_s\": %.6f, \"jitter_most_s\": %.6f, "
	       "\"latency_count\": %llu, \"latency_p50_s\": %.6f, \"latency_p99_s\": %.6f, "
	       "\"latency_most_s\": %.6f, \"force_most_n\": %.3f, \"backed_off_m\": %.4f, "
	       "\"took_over\": %s, \"lost\": ",
	       report->seconds, (unsigned long long)report->commands,
	       (unsigned long long)report->missed, robot_histogram_quantile(&report->jitter, 0.5),
	       robot_histogram_quantile(&report->jitter, 0.99), report->jitter.most_s,
	       (unsigned long long)link->latency.count, robot_histogram_quantile(&link->latency, 0.5),
	       robot_histogram_quantile(&link->latency, 0.99), link->latency.most_s,
	       report->force_most_n, report->backed_off_m, report->took_over ? "true" : "false");
	if (report->lost)
		print_json_text(report->lost);
	else
		printf("null");
	printf("}\n");
}

static int drive(const robot_options *options, const robot_trajectory *trajectory)
{
	static robot_link link; // about 70 kB, too large for the stack
	robot_report report;
	if (!robot_link_open(&link, options, stderr)) {
		robot_link_close(&link);
		return EXIT_NO_TOOL;
	}
	if (!robot_link_wait(&link, WAIT_S)) {
		fprintf(stderr, "cautery-robot: no tool `%s` of session `%s` in domain %d\n", options->tool,
		        options->session, options->domain);
		robot_link_close(&link);
		return EXIT_NO_TOOL;
	}
	printf("the name of this client is \"%s\"\n", link.name); // the server's name for this writer
	fflush(stdout);
	robot_control(&link, options, trajectory, &stop, &report);
	printf("%.1f s, %llu commands, %llu periods missed; force at most %.2f N\n", report.seconds,
	       (unsigned long long)report.commands, (unsigned long long)report.missed,
	       report.force_most_n);
	robot_histogram_print(&report.jitter, "delay of waking", stdout);
	robot_histogram_print(&link.latency, "time from command to state", stdout);
	if (report.lost)
		fprintf(stderr, "cautery-robot: stopped: %s\n", report.lost);
	if (options->json)
		print_json(&report, &link);
	robot_link_close(&link);
	return report.lost ? EXIT_LOST : EXIT_DONE;
}

int main(int argument_count, char **arguments)
{
	robot_options options;
	robot_trajectory trajectory;
	if (!read_options(&options, argument_count, arguments, stderr))
		return EXIT_USAGE;
	if (options.version) {
		puts("cautery-robot " CAUTERY_VERSION);
		return EXIT_DONE;
	}
	if (options.help) {
		print_help(stdout);
		return EXIT_DONE;
	}
	bool good = options.trajectory
	                ? robot_trajectory_read(&trajectory, options.trajectory, stderr)
	                : robot_trajectory_line(&trajectory, options.from_m, options.to_m,
	                                        options.dwell_s, options.speed_m_s);
	if (!good)
		return EXIT_USAGE;
	signal(SIGINT, on_signal);
	signal(SIGTERM, on_signal);
	int code = drive(&options, &trajectory);
	robot_trajectory_finish(&trajectory);
	return code;
}

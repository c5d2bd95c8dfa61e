// SPDX-License-Identifier: GPL-3.0-or-later
// cautery-robot: a robot controller on DDS, as an example and for tests.
#include <signal.h>
#include <stdlib.h>

#include "robot/control.h"

#define WAIT_S 10 // timeout for the session's topics

enum { EXIT_DONE, EXIT_LOST, EXIT_USAGE, EXIT_NO_TOOL };

static volatile int stop;

static void on_signal(int signal_number)
{
	(void)signal_number;
	stop = 1;
}

static void print_json(const robot_report *report, const robot_link *link)
{
	printf("{\"seconds\": %.3f, \"commands\": %llu, \"missed\": %llu, "
	       "\"jitter_p50_s\": %.6f, \"jitter_p99_s\": %.6f, \"jitter_most_s\": %.6f, "
	       "\"latency_count\": %llu, \"latency_p50_s\": %.6f, \"latency_p99_s\": %.6f, "
	       "\"latency_most_s\": %.6f, \"force_most_n\": %.3f, \"backed_off_m\": %.4f, "
	       "\"took_over\": %s, \"lost\": %s%s%s}\n",
	       report->seconds, (unsigned long long)report->commands,
	       (unsigned long long)report->missed, robot_histogram_quantile(&report->jitter, 0.5),
	       robot_histogram_quantile(&report->jitter, 0.99), report->jitter.most_s,
	       (unsigned long long)link->latency.count, robot_histogram_quantile(&link->latency, 0.5),
	       robot_histogram_quantile(&link->latency, 0.99), link->latency.most_s,
	       report->force_most_n, report->backed_off_m, report->took_over ? "true" : "false",
	       report->lost ? "\"" : "", report->lost ? report->lost : "null",
	       report->lost ? "\"" : "");
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
	if (!robot_options_read(&options, argument_count, arguments, stderr))
		return EXIT_USAGE;
	if (options.version) {
		puts("cautery-robot " CAUTERY_VERSION);
		return EXIT_DONE;
	}
	if (options.help) {
		robot_options_help(stdout);
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

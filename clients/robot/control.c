// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/robot.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define LEAST_APPROACH_S 0.2 // least time of the approach, so that the server first sees energy off
#define ANSWER_S 1.0         // timeout for becoming the driver, or for energy to turn on
// Speed along the shaft: away from the tissue if the force is too high, and later back.
#define BACK_OFF_M_S 0.02
#define BACK_OFF_MOST_M 0.03

typedef struct control {
	robot_link *link;
	const robot_options *options;
	const robot_trajectory *trajectory;
	robot_report *report;
	robot_pose first; // pose of the tool when this program became its driver
	double approach_s;
	double along_s;                         // time on the trajectory
	double back_off_m;                      // present retreat along the shaft
	double begun_s, driving_s, following_s; // start times; 0 before the start
} control;

static robot_pose pose_of(const cautery_ToolState *state)
{
	robot_pose pose;
	memcpy(pose.position_m, state->position_m, sizeof pose.position_m);
	memcpy(pose.rotation, state->rotation, sizeof pose.rotation);
	return pose;
}

static double distance(const robot_pose *a, const robot_pose *b)
{
	double squared = 0;
	for (int i = 0; i < 3; i++)
		squared += (a->position_m[i] - b->position_m[i]) * (a->position_m[i] - b->position_m[i]);
	return sqrt(squared);
}

static void sleep_until(double time_s)
{
	double whole = floor(time_s);
	struct timespec until = {(time_t)whole, (long)(1e9 * (time_s - whole))};
	while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) == EINTR)
		;
}

// Moves `pose` back along its shaft, which is +z of the tool.
static void retreat(robot_pose *pose, double by_m)
{
	const double *q = pose->rotation;
	pose->position_m[0] += by_m * 2 * (q[1] * q[3] + q[0] * q[2]);
	pose->position_m[1] += by_m * 2 * (q[2] * q[3] - q[0] * q[1]);
	pose->position_m[2] += by_m * (1 - 2 * (q[1] * q[1] + q[2] * q[2]));
}

// Returns true if the force allows the tool to advance. Changes the retreat by one step: longer if
// the force is too high, else shorter.
static bool heed_force(control *c, double period_s)
{
	const double *f = c->link->force_n;
	double force_n = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
	double limit_n = c->options->force_limit_n;
	bool high = limit_n > 0 && force_n > limit_n;
	double step_m = BACK_OFF_M_S * period_s;
	c->report->force_most_n = fmax(c->report->force_most_n, force_n);
	c->back_off_m =
		high ? fmin(c->back_off_m + step_m, BACK_OFF_MOST_M) : fmax(c->back_off_m - step_m, 0);
	c->report->backed_off_m = fmax(c->report->backed_off_m, c->back_off_m);
	return !high;
}

// Returns the pose of this period. *energy is true if energy is wanted in this period.
static robot_pose next_pose(control *c, double now_s, double period_s, bool *energy)
{
	robot_pose start = robot_trajectory_at(c->trajectory, 0);
	double since_s = now_s - c->driving_s;
	*energy = false;
	if (c->driving_s == 0)
		return pose_of(&c->link->state);
	if (c->options->standby)
		return c->first;
	if (since_s < c->approach_s)
		return robot_pose_between(&c->first, &start, since_s / c->approach_s);
	if (c->following_s == 0)
		c->following_s = now_s;
	if (heed_force(c, period_s))
		c->along_s += period_s;
	robot_pose pose = robot_trajectory_at(c->trajectory, c->along_s);
	retreat(&pose, c->back_off_m);
	*energy = c->options->energy && c->along_s < robot_trajectory_seconds(c->trajectory);
	return pose;
}

static const char *why_lost(const control *c, double now_s, bool energy)
{
	if (c->options->standby || (c->driving_s == 0 && now_s - c->begun_s < ANSWER_S))
		return NULL;
	if (!robot_link_drives(c->link) && !*c->link->state.driver_name)
		return "no client drives the tool: the server does not accept the commands of this program "
			   "(look for event=dds_refused and event=dds_no_place in its log)";
	if (!robot_link_drives(c->link)) {
		snprintf(c->report->lost_text, sizeof c->report->lost_text, "\"%s\" drives the tool",
		         c->link->state.driver_name);
		return c->report->lost_text;
	}
	if (energy && !c->link->state.energized && now_s - c->following_s > ANSWER_S)
		return "energy is off";
	return NULL;
}

static bool is_over(const control *c, double now_s)
{
	const robot_options *options = c->options;
	if (options->seconds > 0)
		return now_s - c->begun_s >= options->seconds;
	return !options->standby && c->along_s >= robot_trajectory_seconds(c->trajectory);
}

// Starts driving. The motion begins at the tool's pose, with energy off.
static void begin_to_drive(control *c, double now_s)
{
	robot_pose start = robot_trajectory_at(c->trajectory, 0);
	c->first = pose_of(&c->link->state);
	c->approach_s = fmax(LEAST_APPROACH_S, distance(&c->first, &start) / c->options->speed_m_s);
	c->driving_s = now_s;
	printf("drives\n");
	fflush(stdout);
}

void robot_control(robot_link *link, const robot_options *options,
                   const robot_trajectory *trajectory, const volatile int *stop,
                   robot_report *report)
{
	control c = {.link = link, .options = options, .trajectory = trajectory, .report = report};
	*report = (robot_report){0};
	c.begun_s = robot_monotonic_s();
	double period_s = 1 / options->rate_hz, due_s = c.begun_s + period_s, now_s = c.begun_s;
	bool energy = false;
	while (!*stop && !report->lost && !is_over(&c, now_s)) {
		sleep_until(due_s);
		now_s = robot_monotonic_s();
		robot_histogram_add(&report->jitter, now_s - due_s);
		robot_link_read(link);
		if (c.driving_s == 0 && robot_link_drives(link))
			begin_to_drive(&c, now_s);
		robot_pose pose = next_pose(&c, now_s, period_s, &energy);
		report->commands += robot_link_write(link, &pose, energy);
		report->lost = why_lost(&c, now_s, energy);
		double missed = floor(fmax(0, now_s - due_s) / period_s);
		report->missed += (uint64_t)missed;
		due_s += (missed + 1) * period_s;
	}
	if (link->has_state) { // The last command turns energy off at the tool's present pose.
		robot_pose rest = pose_of(&link->state);
		robot_link_write(link, &rest, false);
	}
	report->took_over = options->standby && c.driving_s > 0;
	report->seconds = now_s - c.begun_s;
}

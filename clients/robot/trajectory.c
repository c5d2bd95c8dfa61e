// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/robot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WAYPOINTS_MOST = 1 << 20 };

static bool append(robot_trajectory *trajectory, const robot_waypoint *waypoint)
{
	size_t count = trajectory->count;
	if ((count & (count - 1)) == 0) { // The array is full at each power of two.
		size_t capacity = count ? 2 * count : 1;
		void *grown = capacity > WAYPOINTS_MOST
		                  ? NULL
		                  : realloc(trajectory->waypoints, capacity * sizeof *waypoint);
		if (!grown)
			return false;
		trajectory->waypoints = grown;
	}
	trajectory->waypoints[trajectory->count++] = *waypoint;
	return true;
}

static bool normalise(double rotation[4])
{
	double squared = 0;
	for (int i = 0; i < 4; i++)
		squared += rotation[i] * rotation[i];
	for (int i = 0; i < 4; i++)
		rotation[i] /= sqrt(squared);
	return squared > 0.25 && isfinite(squared);
}

// Reads the numbers at the beginning of a line, `most` at most. Returns their count.
static int read_numbers(const char *line, double *number, int most)
{
	int count = 0;
	for (; count < most; count++) {
		char *end;
		double value = strtod(line, &end);
		if (end == line)
			break;
		number[count] = value;
		line = end;
	}
	return count;
}

static bool read_line(robot_waypoint *waypoint, const char *line)
{
	enum { MOST = 8 }; // a line has time (1), position (3) and rotation (4)
	double number[MOST] = {0, 0, 0, 0, 1, 0, 0, 0};
	double *p = waypoint->pose.position_m, *q = waypoint->pose.rotation;
	*waypoint = (robot_waypoint){0};
	int got = read_numbers(line, number, MOST);
	waypoint->time_s = number[0];
	memcpy(p, number + 1, 3 * sizeof *p);
	memcpy(q, number + 4, 4 * sizeof *q);
	return (got == 4 || got == 8) && isfinite(waypoint->time_s) && isfinite(p[0]) &&
	       isfinite(p[1]) && isfinite(p[2]) && normalise(q);
}

bool robot_trajectory_read(robot_trajectory *trajectory, const char *file, FILE *errors)
{
	char line[512];
	int number = 0;
	bool good = true;
	*trajectory = (robot_trajectory){0};
	FILE *stream = fopen(file, "r");
	if (!stream) {
		fprintf(errors, "cautery-robot: cannot open %s\n", file);
		return false;
	}
	while (good && fgets(line, sizeof line, stream)) {
		robot_waypoint waypoint;
		number++;
		if (line[0] == '#' || line[0] == '\n')
			continue;
		double least_s =
			trajectory->count ? trajectory->waypoints[trajectory->count - 1].time_s : 0;
		good = read_line(&waypoint, line) && waypoint.time_s >= least_s &&
		       append(trajectory, &waypoint);
		if (!good)
			fprintf(errors, "cautery-robot: %s:%d: not `T X Y Z [W QX QY QZ]` in order of time\n",
			        file, number);
	}
	fclose(stream);
	if (good && !trajectory->count)
		fprintf(errors, "cautery-robot: %s is empty\n", file);
	good = good && trajectory->count;
	if (!good)
		robot_trajectory_finish(trajectory);
	return good;
}

bool robot_trajectory_line(robot_trajectory *trajectory, const double from_m[3],
                           const double to_m[3], double dwell_s, double speed_m_s)
{
	robot_waypoint start = {.pose.rotation = {1, 0, 0, 0}}, end = start;
	double squared = 0;
	for (int i = 0; i < 3; i++) {
		start.pose.position_m[i] = from_m[i];
		end.pose.position_m[i] = to_m[i];
		squared += (to_m[i] - from_m[i]) * (to_m[i] - from_m[i]);
	}
	*trajectory = (robot_trajectory){0};
	bool good = append(trajectory, &start);
	start.time_s = dwell_s;
	good = good && append(trajectory, &start);
	end.time_s = dwell_s + sqrt(squared) / speed_m_s;
	return good && append(trajectory, &end);
}

void robot_trajectory_finish(robot_trajectory *trajectory)
{
	free(trajectory->waypoints);
	*trajectory = (robot_trajectory){0};
}

double robot_trajectory_seconds(const robot_trajectory *trajectory)
{
	return trajectory->waypoints[trajectory->count - 1].time_s;
}

robot_pose robot_pose_between(const robot_pose *a, const robot_pose *b, double share)
{
	robot_pose pose;
	double dot = 0;
	for (int i = 0; i < 3; i++)
		pose.position_m[i] = a->position_m[i] + share * (b->position_m[i] - a->position_m[i]);
	for (int i = 0; i < 4; i++)
		dot += a->rotation[i] * b->rotation[i];
	// Interpolates along the shorter of the two ways between the rotations.
	for (int i = 0; i < 4; i++)
		pose.rotation[i] =
			(1 - share) * a->rotation[i] + (dot < 0 ? -share : share) * b->rotation[i];
	normalise(pose.rotation);
	return pose;
}

robot_pose robot_trajectory_at(const robot_trajectory *trajectory, double time_s)
{
	// the last waypoint not after time_s is in this range
	size_t low = 0, high = trajectory->count - 1;
	const robot_waypoint *w = trajectory->waypoints;
	if (time_s >= w[high].time_s)
		return w[high].pose;
	while (low + 1 < high) {
		size_t middle = (low + high) / 2;
		if (w[middle].time_s <= time_s)
			low = middle;
		else
			high = middle;
	}
	double span_s = w[high].time_s - w[low].time_s;
	double share = span_s > 0 ? fmax(0, (time_s - w[low].time_s) / span_s) : 0;
	return robot_pose_between(&w[low].pose, &w[high].pose, share);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that a sample passes.
#include "transport_dds/checks.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

// ---- motions
cau_status cau_motion_check_order(const cau_motion_past *past, uint64_t sequence,
                                  int64_t source_time_ns, int64_t now_ns, double now_s,
                                  double limit_s, cau_error *error)
{
	bool anew = now_s - past->pose_s > limit_s;
	if (anew && sequence == 0)
		return cau_fail(error, CAU_BAD_VALUE, "sequence_number",
		                "0 is not allowed: sequence numbers begin with 1");
	if (!anew && sequence <= past->sequence)
		return cau_fail(error, CAU_BAD_VALUE, "sequence_number",
		                "%llu is not larger than the last sequence number, %llu",
		                (unsigned long long)sequence, (unsigned long long)past->sequence);
	if (sequence > CAU_MOTION_SEQUENCE_MOST)
		return cau_fail(error, CAU_BAD_VALUE, "sequence_number", "%llu is beyond 2^53",
		                (unsigned long long)sequence);
	if (!anew && source_time_ns < past->source_time_ns)
		return cau_fail(error, CAU_BAD_VALUE, "source_time_ns",
		                "is earlier than the previous sample by %.6f s",
		                1e-9 * ((double)past->source_time_ns - (double)source_time_ns));
	double age_s = 1e-9 * ((double)now_ns - (double)source_time_ns);
	if (fabs(age_s) > limit_s)
		return cau_fail(error, CAU_BAD_VALUE, "source_time_ns",
		                "is %.3f s old; the limit is %.3f s", age_s, limit_s);
	return CAU_OK;
}

cau_status cau_motion_check_pose(cau_pose *pose, double jaw, cau_error *error)
{
	double squared = 0;
	for (int i = 0; i < 3; i++)
		if (!(fabs(pose->position_m[i]) <= CAU_PLACE_MOST_M))
			return cau_fail(error, CAU_BAD_VALUE, "position_m",
			                "component %d, %g, is not within %g m", i, pose->position_m[i],
			                CAU_PLACE_MOST_M);
	for (int i = 0; i < 4; i++)
		squared += pose->rotation[i] * pose->rotation[i];
	double length = sqrt(squared);
	if (!(fabs(length - 1) <= CAU_UNIT_TOLERANCE))
		return cau_fail(error, CAU_BAD_VALUE, "rotation",
		                "is not a unit quaternion: its length is %g", length);
	if (!(jaw >= 0 && jaw <= 1))
		return cau_fail(error, CAU_BAD_VALUE, "jaw", "%g is not within 0 to 1", jaw);
	for (int i = 0; i < 4; i++)
		pose->rotation[i] /= length;
	return CAU_OK;
}

static double turn_rad(const cau_pose *a, const cau_pose *b)
{
	double dot = 0;
	for (int i = 0; i < 4; i++)
		dot += a->rotation[i] * b->rotation[i];
	return 2 * acos(fmin(fabs(dot), 1));
}

cau_status cau_motion_check_leap(const cau_motion_past *past, const cau_pose *pose, double now_s,
                                 const cau_tool_def *tool, cau_error *error)
{
	if (!past->has_pose)
		return CAU_OK;
	double time_s = now_s - past->pose_s + CAU_MOTION_GRACE_S;
	double distance = hypot(hypot(pose->position_m[0] - past->pose.position_m[0],
	                              pose->position_m[1] - past->pose.position_m[1]),
	                        pose->position_m[2] - past->pose.position_m[2]);
	if (distance > tool->max_speed_m_s * time_s)
		return cau_fail(error, CAU_BAD_VALUE, "position_m",
		                "moves %.4f m in %.3f s, faster than max_speed_m_s %.3g", distance, time_s,
		                tool->max_speed_m_s);
	double turn = turn_rad(&past->pose, pose);
	if (turn > tool->max_turn_rad_s * time_s)
		return cau_fail(error, CAU_BAD_VALUE, "rotation",
		                "turns %.3f rad in %.3f s, faster than max_turn_rad_s %.3g", turn, time_s,
		                tool->max_turn_rad_s);
	return CAU_OK;
}

// ---- keys
void cau_dds_keys_init(cau_dds_keys *keys, const char *session)
{
	*keys = (cau_dds_keys){.tool_count = 0};
	pthread_mutex_init(&keys->mutex, NULL);
	snprintf(keys->session, sizeof keys->session, "%s", session);
}

void cau_dds_keys_finish(cau_dds_keys *keys)
{
	pthread_mutex_destroy(&keys->mutex);
}

void cau_dds_keys_set_tools(cau_dds_keys *keys, const char *const *tools, int count)
{
	pthread_mutex_lock(&keys->mutex);
	keys->tool_count = count;
	for (int i = 0; i < count; i++)
		snprintf(keys->tools[i], sizeof keys->tools[i], "%s", tools[i]);
	pthread_mutex_unlock(&keys->mutex);
}

static bool is_tool(const cau_dds_keys *keys, const char *session, const char *tool)
{
	if (strcmp(session, keys->session) != 0)
		return false;
	for (int i = 0; i < keys->tool_count; i++)
		if (strcmp(tool, keys->tools[i]) == 0)
			return true;
	return false;
}

// True if this key, which names no tool of the session, is in `strangers`. Adds a new key if there
// is capacity.
static bool is_known_stranger(cau_dds_keys *keys, const char *session, const char *tool)
{
	for (int i = 0; i < keys->stranger_count; i++)
		if (strcmp(keys->strangers[i].session, session) == 0 &&
		    strcmp(keys->strangers[i].tool, tool) == 0)
			return true;
	if (keys->stranger_count == CAU_DDS_STRANGERS_MOST)
		return false;
	cau_dds_key *made = &keys->strangers[keys->stranger_count++];
	snprintf(made->session, sizeof made->session, "%s", session);
	snprintf(made->tool, sizeof made->tool, "%s", tool);
	return true;
}

bool cau_dds_keys_admit(cau_dds_keys *keys, const char *session, const char *tool)
{
	pthread_mutex_lock(&keys->mutex);
	bool admitted = is_tool(keys, session, tool) || is_known_stranger(keys, session, tool);
	keys->dropped += !admitted;
	pthread_mutex_unlock(&keys->mutex);
	return admitted;
}

uint64_t cau_dds_keys_take_dropped(cau_dds_keys *keys)
{
	pthread_mutex_lock(&keys->mutex);
	uint64_t dropped = keys->dropped;
	keys->dropped = 0;
	pthread_mutex_unlock(&keys->mutex);
	return dropped;
}

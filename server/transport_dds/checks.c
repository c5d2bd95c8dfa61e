// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "transport_dds/checks.h"

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

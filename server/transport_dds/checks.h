// SPDX-License-Identifier: GPL-3.0-or-later
// What a sample must be before it moves a tool. Pure functions; *error says what is wrong, with the
// path of the field.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/scene.h"
#include "cautery/status.h"

// What is known of a driver's samples for one tool.
typedef struct cau_motion_past {
	uint64_t sequence;      // 0: none yet
	int64_t source_time_ns; // since 1970
	bool has_pose;
	cau_pose pose;
	double pose_s; // when that was accepted, monotonic
} cau_motion_past;

// Grace for jitter on the way: what a tool may do in this time is no leap.
#define CAU_MOTION_GRACE_S 0.05

// Beyond this a sequence number could not be told in JSON.
#define CAU_MOTION_SEQUENCE_MOST 9007199254740991u // 2^53 - 1

// The sequence goes up, to at most CAU_MOTION_SEQUENCE_MOST, the source time does not go back and
// is within `limit_s` of now_ns. Who had nothing accepted for `limit_s`, its deadline, may begin
// anew: its energy is off by then, and a count or clock that went back (an hour, say) is not to
// lock it out until it is where it was. now_s is monotonic.
cau_status cau_motion_check_order(const cau_motion_past *past, uint64_t sequence,
                                  int64_t source_time_ns, int64_t now_ns, double now_s,
                                  double limit_s, cau_error *error);
// Each coordinate lies within CAU_PLACE_MOST_M, as on WebSocket, and the jaw within 0 to 1. The
// rotation is a unit quaternion within CAU_UNIT_TOLERANCE, and is then normalised.
cau_status cau_motion_check_pose(cau_pose *pose, double jaw, cau_error *error);
// Not farther from the last pose than the tool's speed limits allow in the time since, and a grace.
cau_status cau_motion_check_leap(const cau_motion_past *past, const cau_pose *pose, double now_s,
                                 const cau_tool_def *tool, cau_error *error);

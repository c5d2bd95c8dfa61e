// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that a sample passes. Keys are checked before a sample becomes an instance, and motions
// before they move a tool. *error describes the fault and names the path of the field.
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "cautery/command.h"
#include "cautery/scene.h"
#include "cautery/status.h"

// ---- motions
// The functions for motions are pure.

// The last accepted sample of a driver for one tool.
typedef struct cau_motion_past {
	uint64_t sequence;      // 0: no sample was accepted yet
	int64_t source_time_ns; // nanoseconds since 1970
	bool has_pose;
	cau_pose pose;
	double pose_s; // monotonic time when `pose` was accepted
} cau_motion_past;

// Time that is added to the time between two poses, for jitter on the way, s. A tool may move as
// far as its speed limits allow in the sum.
#define CAU_MOTION_GRACE_S 0.05

// Largest sequence number: larger integers are not exact in JSON numbers.
#define CAU_MOTION_SEQUENCE_MOST 9007199254740991u // 2^53 - 1

// Checks the order of samples. The sequence must increase, to at most CAU_MOTION_SEQUENCE_MOST. The
// source time must not decrease and must be within `limit_s` of now_ns. If no sample of a driver
// was accepted for `limit_s`, its deadline, the driver may start with a new sequence and time: its
// energy is off by then. Without this exception, a driver whose count or clock was set back by an
// hour would be locked out for that hour. now_s is monotonic.
cau_status cau_motion_check_order(const cau_motion_past *past, uint64_t sequence,
                                  int64_t source_time_ns, int64_t now_ns, double now_s,
                                  double limit_s, cau_error *error);
// Checks a pose. Each coordinate must be within CAU_PLACE_MOST_M, as on WebSocket, and the jaw
// within 0 to 1. The rotation must be a unit quaternion within CAU_UNIT_TOLERANCE; the function
// normalises it.
cau_status cau_motion_check_pose(cau_pose *pose, double jaw, cau_error *error);
// Checks that the pose is no farther from the last pose than the tool's speed limits allow, in the
// time since then plus CAU_MOTION_GRACE_S.
cau_status cau_motion_check_leap(const cau_motion_past *past, const cau_pose *pose, double now_s,
                                 const cau_tool_def *tool, cau_error *error);

// ---- keys
// Decides which instances of cautery/tool_command a session's reader accepts. Cyclone keeps an
// instance as long as its writer exists, so a writer with invented keys could fill the memory.
// Beyond a few such keys, samples are dropped and counted before they become instances.

// Number of accepted keys that name no tool of the session, so that a sender with a wrong name gets
// an error.
enum { CAU_DDS_STRANGERS_MOST = 64 };

typedef struct cau_dds_key {
	char session[CAU_NAME_BYTES], tool[CAU_NAME_BYTES];
} cau_dds_key;

typedef struct cau_dds_keys {
	pthread_mutex_t mutex; // guards the other members: the filter runs on Cyclone's threads
	char session[CAU_NAME_BYTES];
	char tools[CAU_MAX_TOOLS][CAU_NAME_BYTES];
	int tool_count, stranger_count;
	cau_dds_key strangers[CAU_DDS_STRANGERS_MOST];
	uint64_t dropped;
} cau_dds_keys;

void cau_dds_keys_init(cau_dds_keys *keys, const char *session);
void cau_dds_keys_finish(cau_dds_keys *keys);
// Sets the session's tools, at most CAU_MAX_TOOLS.
void cau_dds_keys_set_tools(cau_dds_keys *keys, const char *const *tools, int count);
// True if the reader accepts a sample of this key.
bool cau_dds_keys_admit(cau_dds_keys *keys, const char *session, const char *tool);
// Returns the number of dropped samples since the last call.
uint64_t cau_dds_keys_take_dropped(cau_dds_keys *keys);

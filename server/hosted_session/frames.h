// SPDX-License-Identifier: GPL-3.0-or-later
// The session's side of its streams.
#pragma once

#include <stdatomic.h>

#include "cautery/session.h"
#include "hosted_session/sink.h"
#include "stream/stream.h"

typedef struct cau_hosted_frames {
	cau_streams streams; // with a lock of its own
	atomic_bool dirty;   // any thread: streams must show a change that no step made
	uint64_t epoch;      // of the thread that has the session
} cau_hosted_frames;

void cau_frames_publish(cau_hosted *h, double now_s); // those that are due
void cau_frames_restart(cau_hosted_frames *frames);   // a new epoch
cau_stream_shape cau_frames_shape(const cau_session_info *info);

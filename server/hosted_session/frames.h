// SPDX-License-Identifier: GPL-3.0-or-later
// The frames that a session publishes to its streams.
#pragma once

#include <stdatomic.h>

#include "cautery/session.h"
#include "hosted_session/sink.h"
#include "stream/stream.h"

typedef struct cau_hosted_frames {
	cau_streams streams; // has its own lock
	atomic_bool dirty;   // any thread: the streams must show a change that no step made
	uint64_t epoch;      // epoch of the next frame; only for the owning thread
} cau_hosted_frames;

void cau_frames_publish(cau_hosted *h, double now_s); // publishes to the streams that are due
void cau_frames_restart(cau_hosted_frames *frames);   // begins a new epoch
cau_stream_shape cau_frames_shape(const cau_session_info *info);

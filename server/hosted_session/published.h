// SPDX-License-Identifier: GPL-3.0-or-later
// A session's measurements, its published values for other threads, and the frames of its streams.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "cautery/session.h"
#include "hosted_session/hosted.h"
#include "hosted_session/sink.h"
#include "stream/stream.h"

// ---- pace ---------------------------------------------------------------------------------------
// The speed of a session, and its measured times. Only the session's owning thread (internal.h)
// uses this.

enum { WAITING_COUNT = 32 }; // most commands between two frames whose delay is measured

typedef struct cau_hosted_pace {
	double window_s; // start of the window over which realtime_factor is measured
	uint64_t window_tick;
	double realtime_factor;
	double step_cost_s;
	double piece_s;   // estimated processor time of the longest recent step; the pool plans with it
	double stepped_s; // processor time of the steps in this slice
	// how late the present tick began; negative: the session does not follow the clock
	double late_s;
	double waiting_s[WAITING_COUNT]; // arrival times of commands that no frame has shown yet
	int32_t waiting_count;
} cau_hosted_pace;

// Starts a new window of realtime_factor at this tick. Call this after a pause or a change of the
// tick.
void cau_pace_restart(cau_hosted_pace *pace, uint64_t tick);
// Updates realtime_factor once its window has passed.
void cau_pace_measure(cau_hosted_pace *pace, uint64_t tick, double tick_step_s);
// Notes the processor time of a step. A long step is forgotten over about ten steps.
void cau_pace_expect(cau_hosted_pace *pace, double took_s);
// ---- times over all sessions; `times` may be NULL
void cau_pace_stepped(const cau_hosted_pace *pace, cau_hosted_times *times,
                      const cau_statistics *statistics); // call this after each step
// Notes a command that came at `came_s` and waits for the frame that shows it. For each frame, only
// the first WAITING_COUNT commands are measured.
void cau_pace_await_frame(cau_hosted_pace *pace, double came_s);
// call this when a frame was made
void cau_pace_framed(cau_hosted_pace *pace, cau_hosted_times *times);

// ---- values for other threads -------------------------------------------------------------------
// The values of a session that other threads may read. The session's owning thread (internal.h)
// publishes them. The lock guards all of them and is held briefly.

typedef struct cau_hosted_published {
	pthread_mutex_t lock;
	cau_wire_session_summary summary;
	cau_hosted_counts counts;
	cau_tool_state tools[CAU_MAX_TOOLS]; // of the newest tick; transports read them
	int32_t tool_count;
	uint64_t tick; // tick of `tools`
	double time_s;
} cau_hosted_published;

// Publishes the session's present state for other threads. Only the owning thread calls this.
void cau_hosted_publish_summary(cau_hosted *h);
void cau_hosted_publish_tools(cau_hosted *h);
// Adds *more to the counts. After a step, the members that describe one step are replaced.
void cau_published_count(cau_hosted_published *published, const cau_hosted_counts *more);

// ---- what streams send of a core ----------------------------------------------------------------
// The frame, tools and statistics of one tick of a core, in the form that streams send.

// `sample` points into the other members, and into the core.
typedef struct cau_shown {
	cau_frame frame;
	cau_stream_tool tools[CAU_MAX_TOOLS]; // without their drivers
	cau_stream_statistics statistics;
	cau_stream_sample sample;
} cau_shown;
void cau_show(const cau_session *core, cau_shown *shown);

// ---- frames -------------------------------------------------------------------------------------
// The frames that a session publishes to its streams.

typedef struct cau_hosted_frames {
	cau_streams streams; // has its own lock
	atomic_bool dirty;   // any thread: the streams must show a change that no step made
	uint64_t epoch;      // epoch of the next frame; only for the owning thread
} cau_hosted_frames;

void cau_frames_publish(cau_hosted *h, double now_s); // publishes to the streams that are due
void cau_frames_restart(cau_hosted_frames *frames);   // begins a new epoch
cau_stream_shape cau_frames_shape(const cau_session_info *info);

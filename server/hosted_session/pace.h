// SPDX-License-Identifier: GPL-3.0-or-later
// The speed of a session, and its measured times. Only the session's owning thread (internal.h)
// uses this.
#pragma once

#include "cautery/session.h"
#include "hosted_session/hosted.h"

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

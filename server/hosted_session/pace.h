// SPDX-License-Identifier: GPL-3.0-or-later
// How fast a session goes, and what is measured of it. It belongs to the thread that has the
// session.
#pragma once

#include "cautery/session.h"
#include "hosted_session/hosted.h"

enum { WAITING_COUNT = 32 }; // commands between two frames whose wait is measured

typedef struct cau_hosted_pace {
	double window_s; // realtime_factor's window
	uint64_t window_tick;
	double realtime_factor;
	double step_cost_s;
	double piece_s;   // processor time of the longest step lately, for the pool
	double stepped_s; // of the steps in this slice
	double late_s;    // how late the tick that is to be made began; below 0: the clock does not say
	double waiting_s[WAITING_COUNT]; // when commands came that no frame has shown yet
	int32_t waiting_count;
} cau_hosted_pace;

// Begins realtime_factor's window now, at this tick: after a pause, or elsewhere in time.
void cau_pace_restart(cau_hosted_pace *pace, uint64_t tick);
// Measures realtime_factor, once its window is over.
void cau_pace_measure(cau_hosted_pace *pace, uint64_t tick, double tick_step_s);
// A step took this long. The longest lately is forgotten over some ten steps.
void cau_pace_expect(cau_hosted_pace *pace, double took_s);
// ---- what is measured of all sessions together; `times` may be NULL
void cau_pace_stepped(const cau_hosted_pace *pace, cau_hosted_times *times,
                      const cau_statistics *statistics); // after each step
// A command that came at `came_s` waits for the frame that shows it. Of one frame's commands at
// most WAITING_COUNT are measured, the first.
void cau_pace_await_frame(cau_hosted_pace *pace, double came_s);
void cau_pace_framed(cau_hosted_pace *pace, cau_hosted_times *times); // a frame was made

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/pace.h"

#include <math.h>

#include "clock/clock.h"

#define FACTOR_WINDOW_S 1.0 // window over which realtime_factor is measured, s
// factor by which piece_s falls from step to step, unless a step takes longer than piece_s
#define PIECE_KEPT 0.9

_Static_assert((int)CAU_HOSTED_STAGES == (int)CAU_STAGE_COUNT,
               "a histogram for each stage of the core");

const char *cau_hosted_stage_name(int stage)
{
	static const char *const names[] = {
#define X(code, name) name,
		CAU_STAGE_TABLE(X)
#undef X
	};
	return names[stage];
}

void cau_pace_restart(cau_hosted_pace *pace, uint64_t tick)
{
	pace->window_s = cau_monotonic_s();
	pace->window_tick = tick;
}

void cau_pace_measure(cau_hosted_pace *pace, uint64_t tick, double tick_step_s)
{
	double now_s = cau_monotonic_s(), wall_s = now_s - pace->window_s;
	if (wall_s < FACTOR_WINDOW_S)
		return;
	pace->realtime_factor = (double)(tick - pace->window_tick) * tick_step_s / wall_s;
	pace->window_s = now_s;
	pace->window_tick = tick;
}

void cau_pace_expect(cau_hosted_pace *pace, double took_s)
{
	pace->stepped_s += took_s;
	pace->piece_s = fmax(took_s, PIECE_KEPT * pace->piece_s);
}

void cau_pace_stepped(const cau_hosted_pace *pace, cau_hosted_times *times,
                      const cau_statistics *statistics)
{
	if (!times)
		return;
	cau_histogram_note(&times->step, pace->step_cost_s);
	for (int i = 0; i < CAU_STAGE_COUNT; i++)
		cau_histogram_note(&times->stage[i], statistics->seconds[i]);
	if (pace->late_s >= 0)
		cau_histogram_note(&times->lateness, pace->late_s);
}

void cau_pace_await_frame(cau_hosted_pace *pace, double came_s)
{
	if (pace->waiting_count < WAITING_COUNT)
		pace->waiting_s[pace->waiting_count++] = came_s;
}

void cau_pace_framed(cau_hosted_pace *pace, cau_hosted_times *times)
{
	double now_s = cau_monotonic_s();
	for (int i = 0; i < pace->waiting_count && times; i++)
		cau_histogram_note(&times->command_to_frame, now_s - pace->waiting_s[i]);
	pace->waiting_count = 0;
}

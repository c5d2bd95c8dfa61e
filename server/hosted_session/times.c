// SPDX-License-Identifier: GPL-3.0-or-later
// What is measured of all sessions together: how long steps and their stages take, how late they
// begin, and how long a command waits for the frame that shows it.
#include "hosted_session/internal.h"

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

void cau_times_stepped(cau_hosted *h, const cau_statistics *statistics)
{
	cau_hosted_times *times = h->around->times;
	if (!times)
		return;
	cau_histogram_note(&times->step, h->step_cost_s);
	for (int i = 0; i < CAU_STAGE_COUNT; i++)
		cau_histogram_note(&times->stage[i], statistics->seconds[i]);
	if (h->late_s >= 0)
		cau_histogram_note(&times->lateness, h->late_s);
}

// Only what acts in the tick that begins now has a frame to wait for; while the session is paused
// nobody knows when that is. Of one frame's commands at most WAITING_COUNT are measured, the first.
void cau_times_applied(cau_hosted *h, const cau_order *order)
{
	bool next = order->as.command.tick <= h->tick;
	if (next && cau_decided_state(h) == CAU_SESSION_RUNNING && h->waiting_count < WAITING_COUNT)
		h->waiting_s[h->waiting_count++] = order->came_s;
}

// Without subscribers there is no frame to wait for.
void cau_times_published(cau_hosted *h, bool made)
{
	cau_hosted_times *times = h->around->times;
	cau_stream_counts streams;
	if (!h->waiting_count)
		return;
	double now_s = cau_monotonic_s();
	for (int i = 0; i < h->waiting_count && made && times; i++)
		cau_histogram_note(&times->command_to_frame, now_s - h->waiting_s[i]);
	cau_streams_count(&h->streams, &streams);
	if (made || !streams.subscribers || cau_decided_state(h) != CAU_SESSION_RUNNING)
		h->waiting_count = 0;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The time of a session: its pace, the orders about time, and session.destroy.
#include "hosted_session/slice.h"

#include <math.h>

#include "cautery/assert.h"
#include "clock/clock.h"
#include "hosted_session/internal.h"
#include "hosted_session/published.h"

// ---- pace ---------------------------------------------------------------------------------------

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

// ---- orders about time, and session.destroy -----------------------------------------------------

static void answer_summary(cau_hosted *h, cau_order *order, int change)
{
	cau_wire_session_summary summary;
	cau_answer_changed(h, change, order->asker.name);
	cau_hosted_summary(h, &summary);
	cau_answer_order(&h->record, order, &summary);
}

cau_outcome_kind cau_apply_pause(cau_hosted *h, cau_order *order, const cau_action *action)
{
	if (action->changed) {
		h->pace.realtime_factor = 0;
		cau_timeline_end_cuts(&h->timeline);
		cau_record_state(&h->record, cau_decisions_state(&h->decisions));
		cau_record_checkpoint(&h->record, NULL, NULL);
	}
	h->frames.dirty = true;
	if (order)
		answer_summary(h, order, CAU_CHANGE_PAUSED);
	else
		cau_answer_changed(h, CAU_CHANGE_PAUSED, NULL);
	return CAU_DONE;
}

cau_outcome_kind cau_apply_resume(cau_hosted *h, cau_order *order, const cau_action *action)
{
	if (action->changed) {
		cau_pace_restart(&h->pace, h->core.tick);
		cau_record_state(&h->record, cau_decisions_state(&h->decisions));
	}
	answer_summary(h, order, CAU_CHANGE_RESUMED);
	return CAU_DONE;
}

// Does nothing itself. The ticks are computed one by one, then cau_time_stepped answers the order.
cau_outcome_kind cau_apply_step(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)h, (void)order, (void)action;
	return CAU_DONE;
}

void cau_time_stepped(cau_hosted *h, cau_order *order, bool failed)
{
	cau_wire_tick_result result = {(int64_t)h->core.tick, 0};
	cau_error error = {0};
	cau_decided decided = cau_decisions_now(&h->decisions);
	if (failed && !*decided.fault) { // the session has ended
		cau_hosted_refuse_gone(&h->life, order);
		return;
	}
	if (failed) {
		cau_fail(&error, CAU_FAULTED, "", "%s", decided.fault);
		cau_answer_fail(order, &error, CAU_RPC_FAULTED);
		return;
	}
	if (order->kind == CAU_ORDER_ADVANCE) {
		cau_advance_answer(h, order);
		return;
	}
	cau_timeline_end_cuts(&h->timeline);
	h->frames.dirty = true; // publish the last state, whatever the rates of the streams
	cau_record_reached(&h->record);
	cau_answer_changed(h, CAU_CHANGE_STEPPED, order->asker.name);
	cau_answer_order(&h->record, order, &result);
}

cau_outcome_kind cau_apply_speed(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	answer_summary(h, order, CAU_CHANGE_SPEED);
	return CAU_DONE;
}

bool cau_hosted_destroy(cau_hosted *h, cau_order *order, bool stored)
{
	cau_error error = {0};
	cau_wire_nothing result = {0};
	cau_store_batch *batch = cau_record_batch(&h->record);
	if (stored && (!batch || cau_store_delete_session(batch, h->identity.id, &error))) {
		cau_answer_refuse(order, CAU_NO_MEMORY, "", "no memory to destroy it");
		return false;
	}
	cau_answer_changed(h, CAU_CHANGE_DESTROYED, order->asker.name);
	cau_log(CAU_LOG_INFO, h->identity.id, "destroyed", "client=\"%s\"", order->asker.name);
	cau_answer_order(&h->record, order, &result);
	return true;
}

cau_outcome_kind cau_apply_destroy(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	if (!cau_hosted_destroy(h, order, true))
		return CAU_NOT_DONE;
	h->life.ended = true;
	return CAU_DONE;
}

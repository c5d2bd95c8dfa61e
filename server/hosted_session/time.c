// SPDX-License-Identifier: GPL-3.0-or-later
// Orders about time, and session.destroy.

#include "hosted_session/answer.h"
#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

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

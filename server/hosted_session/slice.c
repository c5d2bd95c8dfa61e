// SPDX-License-Identifier: GPL-3.0-or-later
// Ends a slice, on a worker or on the builder, and refuses orders.
#include "hosted_session/slice.h"

#include "cautery/assert.h"
#include "hosted_session/internal.h"

void cau_hosted_end_slice(cau_hosted *h)
{
	cau_record_commit(h);
	cau_decisions_flush_trace(&h->decisions, h->identity.id);
	if (!h->creation.starting)
		h->creation.unanswered = false;
	cau_hosted_publish_summary(h);
	cau_hosted_publish_tools(h);
	h->identity.around->sink.sliced(h->identity.around->sink.user, h->identity.number);
}

void cau_hosted_refuse_order(cau_hosted *h, cau_order *order, const cau_error *error, int32_t code)
{
	if (code == CAU_RPC_NOT_HERE) {
		cau_hosted_refuse_gone(&h->life, order);
		return;
	}
	if (order->kind == CAU_ORDER_COMMAND) {
		h->findings.refused_commands++;
		if (order->motion)
			cau_refusals_note(&h->refusals, order, error);
	}
	cau_answer_fail(order, error, code);
}

void cau_hosted_refuse_rest(cau_hosted *h)
{
	cau_action action;
	CAU_ASSERT(h->decisions.logic->ended, "orders of session %s are refused before it ends",
	           h->identity.id);
	for (cau_decide_next(h, &action); action.act != CAU_ACT_NOTHING; cau_decide_next(h, &action)) {
		cau_order *order = (cau_order *)(uintptr_t)action.ticket;
		if (action.act == CAU_ACT_REFUSE)
			cau_hosted_refuse_order(h, order, &action.error, action.code);
		else if (action.act == CAU_ACT_STEP_FAILED)
			cau_time_stepped(h, order, true);
		cau_decide_done(h, CAU_DONE);
	}
	cau_reads_refuse(h);
}

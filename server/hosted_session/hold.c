// SPDX-License-Identifier: GPL-3.0-or-later
// Suspends a session that moves to another daemon. The builder has the session then, as while it is
// being built, but without a running job. Orders wait.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

#define STOPS_EXPECTED_S 0.01 // expected time of a commit, s, by which the builder sorts its jobs

typedef struct cau_holding {
	cau_job job; // must be the first member
	cau_hosted *hosted;
	cau_order *order; // the order to suspend the session, until it is answered
	uint64_t hash;
} cau_holding;

// ---- suspension ---------------------------------------------------------------------------------

static void finish(cau_holding *holding)
{
	cau_hosted *h = holding->hosted;
	h->suspension.holding = NULL;
	cau_suspension_name_stage(&h->suspension, "");
	free(holding);
	cau_building_over(h);
	cau_hosted_release(h);
}

static void run_on(cau_job *job)
{
	cau_holding *holding = (cau_holding *)job;
	cau_hosted *h = holding->hosted;
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_STAYED, .time_s = cau_monotonic_s()});
	cau_pace_restart(&h->pace, h->core.tick);
	h->frames.dirty = true;
	finish(holding);
}

// Answers the hold. The session's whole state is on the disk once the store has flushed.
static void run_stop(cau_job *job)
{
	cau_holding *holding = (cau_holding *)job;
	cau_hosted *h = holding->hosted;
	cau_error error = {0};
	cau_outcome outcome = {0};
	cau_order *order = holding->order;
	cau_wire_move_held result = {.tick = (int64_t)h->core.tick, .hash = holding->hash};
	cau_store_flush(h->identity.around->store);
	bool stored = h->commits.lost_from == UINT64_MAX;
	char *text =
		stored ? cau_answer_text(order->reply.method, &result, &outcome.text_bytes, &error) : NULL;
	holding->order = NULL;
	holding->job.run = holding->job.drop = run_on;
	if (!stored)
		cau_fail(&error, CAU_IO, "", "the store has not written all commands yet: try again later");
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	// from here on cau_hosted_go_on or cau_hosted_go_away may be called
	cau_reply_answer(&order->reply, &outcome);
	free(order);
	free(text);
	if (error.status)
		run_on(job);
}

static void drop_stop(cau_job *job)
{
	cau_holding *holding = (cau_holding *)job;
	cau_answer_fail(holding->order, &cau_daemon_ends, CAU_RPC_DRAINING);
	run_on(job);
}

cau_outcome_kind cau_apply_hold(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	if (cau_decisions_state(&h->decisions) == CAU_SESSION_FAULTED)
		return cau_answer_refuse(order, CAU_FAULTED, "",
		                         "a faulted session cannot move: rewind or reset it");
	cau_holding *holding = calloc(1, sizeof *holding);
	if (!holding)
		return cau_answer_refuse(order, CAU_NO_MEMORY, "", "no memory to suspend the session");
	holding->job = (cau_job){.run = run_stop, .drop = drop_stop, .expected_s = STOPS_EXPECTED_S};
	holding->hosted = cau_hosted_share(h);
	holding->order = order;
	cau_timeline_end_cuts(&h->timeline);
	cau_record_state(&h->record, cau_decisions_state(&h->decisions));
	cau_record_checkpoint(&h->record, NULL, NULL);
	holding->hash = cau_session_hash(h->core.session);
	h->suspension.holding = holding;
	h->suspension.job = &holding->job;
	cau_suspension_name_stage(&h->suspension, "moving");
	cau_hosted_publish_summary(h);
	return CAU_DONE;
}

void cau_hosted_go_on(cau_hosted *h)
{
	CAU_ASSERT(h->suspension.holding && !h->suspension.holding->order,
	           "session %s is not suspended", h->identity.id);
	cau_builder_submit(h->identity.around->mover, &h->suspension.holding->job);
}

static void run_away(cau_job *job)
{
	cau_holding *holding = (cau_holding *)job;
	cau_hosted *h = holding->hosted;
	cau_wire_session_changed changed = {.change = CAU_CHANGE_MOVED, .has_moved_to = true};
	cau_hosted_summary(h, &changed.summary);
	memcpy(changed.moved_to, h->life.moved.session, sizeof changed.moved_to);
	changed.has_target = *h->life.moved.url;
	snprintf(changed.target, sizeof changed.target, "%s", h->life.moved.url);
	cau_answer_notify(&h->identity, (cau_audience){CAU_AUDIENCE_EVERYBODY, h->identity.number},
	                  CAU_METHOD_SESSION_CHANGED, &changed);
	cau_log(CAU_LOG_NOTICE, h->identity.id, "moved", "tick=%llu to=%s url=\"%s\"",
	        (unsigned long long)h->core.tick, h->life.moved.session, h->life.moved.url);
	cau_hosted_end(h);
	finish(holding);
}

void cau_hosted_go_away(cau_hosted *h, const cau_moved_to *to)
{
	CAU_ASSERT(h->suspension.holding && !h->suspension.holding->order,
	           "session %s is not suspended", h->identity.id);
	h->life.moved = *to;
	h->suspension.holding->job.run = h->suspension.holding->job.drop = run_away;
	cau_builder_submit(h->identity.around->mover, &h->suspension.holding->job);
}

int32_t cau_hosted_hands(cau_hosted *h, cau_drive *drives, double *speed)
{
	*speed = cau_decisions_now(&h->decisions).speed;
	return cau_decisions_drives(&h->decisions, drives);
}

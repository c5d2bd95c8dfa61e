// SPDX-License-Identifier: GPL-3.0-or-later
// A session that moves to another daemon stands still where it leaves. It is the builder's then, as
// while it is built, with no job under way; what is asked of it waits.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "hosted_session/internal.h"

#define STOPS_EXPECTED_S 0.01 // a commit, for the builder's order

typedef struct cau_holding {
	cau_job job; // first
	cau_hosted *hosted;
	cau_order *order; // to stand still, until it is answered
	uint64_t hash;
} cau_holding;

// ---- standing still -----------------------------------------------------------------------------

static void finish(cau_holding *holding)
{
	cau_hosted *h = holding->hosted;
	h->holding = NULL;
	h->stage[0] = 0;
	free(holding);
	cau_building_over(h);
	cau_hosted_release(h);
}

static void run_on(cau_job *job)
{
	cau_holding *holding = (cau_holding *)job;
	cau_hosted *h = holding->hosted;
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_STAYED, .time_s = cau_monotonic_s()});
	h->window_s = cau_monotonic_s();
	h->window_tick = h->tick;
	h->dirty = true;
	finish(holding);
}

// All that it was is on the disk once the store has answered what it was given.
static void run_stop(cau_job *job)
{
	cau_holding *holding = (cau_holding *)job;
	cau_hosted *h = holding->hosted;
	cau_error error = {0};
	cau_outcome outcome = {0};
	cau_order *order = holding->order;
	cau_wire_move_held result = {.tick = (int64_t)h->tick, .hash = holding->hash};
	cau_store_flush(h->around->store);
	bool stored = h->lost_from == UINT64_MAX;
	char *text =
		stored ? cau_answer_text(order->reply.method, &result, &outcome.text_bytes, &error) : NULL;
	holding->order = NULL;
	holding->job.run = holding->job.drop = run_on;
	if (!stored)
		cau_fail(&error, CAU_IO, "", "the store has not stored all commands yet: try again later");
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	cau_reply_answer(&order->reply, &outcome); // from here on the session may go on or away
	free(order);
	free(text);
	if (error.status)
		run_on(job);
}

static void drop_stop(cau_job *job)
{
	cau_holding *holding = (cau_holding *)job;
	cau_error error = {0};
	cau_fail(&error, CAU_BAD_STATE, "", "the daemon is ending");
	cau_answer_fail(holding->order, &error, CAU_RPC_DRAINING);
	run_on(job);
}

static cau_outcome_kind refuse(cau_order *order, cau_status status, const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, status, "", "%s", reason);
	cau_answer_fail(order, &error, 0);
	return CAU_NOT_DONE;
}

cau_outcome_kind cau_apply_hold(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	if (cau_decided_state(h) == CAU_SESSION_FAULTED)
		return refuse(order, CAU_FAULTED, "a faulted session cannot move: rewind or reset it");
	cau_holding *holding = calloc(1, sizeof *holding);
	if (!holding)
		return refuse(order, CAU_NO_MEMORY, "no memory to suspend the session");
	holding->job = (cau_job){.run = run_stop, .drop = drop_stop, .expected_s = STOPS_EXPECTED_S};
	holding->hosted = cau_hosted_share(h);
	holding->order = order;
	cau_event_end_cut(h);
	cau_record_state(h);
	cau_record_checkpoint(h, NULL, NULL);
	holding->hash = cau_session_hash(h->core);
	h->holding = holding;
	h->leaving = &holding->job;
	snprintf(h->stage, sizeof h->stage, "moving");
	cau_hosted_publish_summary(h);
	return CAU_DONE;
}

void cau_hosted_go_on(cau_hosted *h)
{
	CAU_ASSERT(h->holding && !h->holding->order, "session %s is not suspended", h->id);
	cau_builder_submit(h->around->mover, &h->holding->job);
}

static void run_away(cau_job *job)
{
	cau_holding *holding = (cau_holding *)job;
	cau_hosted *h = holding->hosted;
	cau_wire_session_changed changed = {.change = CAU_CHANGE_MOVED, .has_moved_to = true};
	cau_hosted_summary(h, &changed.summary);
	memcpy(changed.moved_to, h->moved.session, sizeof changed.moved_to);
	changed.has_target = *h->moved.url;
	snprintf(changed.target, sizeof changed.target, "%s", h->moved.url);
	cau_answer_notify(h, (cau_audience){CAU_AUDIENCE_EVERYBODY, h->number},
	                  CAU_METHOD_SESSION_CHANGED, &changed);
	cau_log(CAU_LOG_NOTICE, h->id, "moved", "tick=%llu to=%s url=\"%s\"",
	        (unsigned long long)h->tick, h->moved.session, h->moved.url);
	cau_hosted_end(h);
	finish(holding);
}

void cau_hosted_go_away(cau_hosted *h, const cau_moved_to *to)
{
	CAU_ASSERT(h->holding && !h->holding->order, "session %s is not suspended", h->id);
	h->moved = *to;
	h->holding->job.run = h->holding->job.drop = run_away;
	cau_builder_submit(h->around->mover, &h->holding->job);
}

int32_t cau_hosted_hands(cau_hosted *h, cau_drive *drives, double *speed)
{
	pthread_mutex_lock(&h->deciding);
	*speed = h->logic->speed;
	pthread_mutex_unlock(&h->deciding);
	return cau_decide_drives(h, drives);
}

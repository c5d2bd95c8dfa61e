// SPDX-License-Identifier: GPL-3.0-or-later
// Rewind, reset and restore, and the check of a fork's tick.
//
// The worker hands the session to the builder, at a tick border with energy off. Orders wait
// meanwhile. The builder alone uses the session, as while it builds one, and works in stages: it
// reads the past, restores the checkpoint, and replays the log in slices. Between the stages it
// reports its progress and checks whether a client destroys the session. The present state is kept
// until the new one is reached. If that fails, the session continues from its present state.
#include <stdlib.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

// Estimated times of the stages, s, and s for each vertex. The builder sorts its jobs by them.
// Restoring a sheet of 250,000 vertices takes 1.5 s.
#define READ_EXPECTED_S 0.02
#define RESTORED_VERTEX_S 6e-6
#define SLICE_S 0.1 // length of one turn of a replay, s; after each turn other short jobs may run

typedef struct going {
	cau_job job; // must be the first member
	cau_hosted *hosted;
	cau_order *order;
	enum { READING, RESTORING, REPLAYING, STAGE_COUNT } stage;
	int64_t branch; // branch and tick to reach
	uint64_t tick, present_tick;
	bool left;     // the core has left the present state
	void *present; // snapshot of the present state; NULL: none
	size_t present_bytes;
} going;

static const char *const stage_names[STAGE_COUNT] = {"reading", "restoring", "replaying"};

// ---- the past -----------------------------------------------------------------------------------

// Ends a gap of the log with a checkpoint, which reports the gap to the store. Until the checkpoint
// is stored, no rewind may reach into the gap.
static void end_gap(cau_hosted_record *record)
{
	if (record->commits->lost_from != UINT64_MAX)
		cau_record_checkpoint(record, NULL, NULL);
}

// ---- arriving -----------------------------------------------------------------------------------

static int change_of(cau_order_kind kind, int *event)
{
	*event = kind == CAU_ORDER_RESET     ? CAU_EVENT_RESET
	         : kind == CAU_ORDER_RESTORE ? CAU_EVENT_RESTORE
	                                     : CAU_EVENT_REWIND;
	return kind == CAU_ORDER_RESET     ? CAU_CHANGE_RESET
	       : kind == CAU_ORDER_RESTORE ? CAU_CHANGE_RESTORED
	                                   : CAU_CHANGE_REWOUND;
}

static void open_branch(cau_hosted *h)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(&h->record);
	cau_store_branch row = {.session = h->identity.id,
	                        .branch = h->history.next_branch,
	                        .parent = h->history.branch,
	                        .fork_tick = h->core.tick};
	cau_status status = batch ? cau_store_put_branch(batch, &row, &error) : CAU_NO_MEMORY;
	if (status)
		cau_log(CAU_LOG_ERROR, h->identity.id, "branch_lost", "reason=\"%s\"", error.reason);
	h->history.branch = h->history.next_branch++;
	h->record.logged_order = 0;
	h->record.logged_tick = UINT64_MAX;
}

static void arrive(cau_hosted *h, int64_t branch, cau_order *order)
{
	int event;
	int change = change_of(order->kind, &event);
	int state = cau_decisions_state(&h->decisions);
	cau_findings_know(&h->findings, h->core.session);
	h->history.branch = branch;
	cau_suspension_name_stage(&h->suspension, "");
	cau_timeline_load(&h->timeline);
	open_branch(h);
	cau_timeline_add(&h->timeline, event, NULL, order->asker.name, 0, NULL);
	cau_record_checkpoint(&h->record, NULL, NULL);
	cau_decide_arrived(h, state == CAU_SESSION_FAULTED ? CAU_SESSION_PAUSED : state,
	                   "the session was rewound");
	cau_frames_restart(&h->frames);
	cau_record_state(&h->record, cau_decisions_state(&h->decisions));
	cau_pace_restart(&h->pace, h->core.tick);
	cau_wire_restored result = {.tick = (int64_t)h->core.tick,
	                            .epoch = h->frames.epoch,
	                            .branch = h->history.branch,
	                            .exact = h->replay.exact};
	cau_answer_changed(h, change, order->asker.name);
	cau_answer_order(&h->record, order, &result);
}

// ---- after a failure ----------------------------------------------------------------------------

static cau_status return_to_present(going *g, cau_error *error)
{
	bool exact;
	if (!g->left)
		return CAU_OK;
	g->hosted->core.tick = g->present_tick;
	if (!g->present)
		return cau_fail(error, CAU_FAULTED, "",
		                "the session was faulted before the rewind, and is still faulted");
	return cau_session_restore(g->hosted->core.session, g->present, g->present_bytes, &exact,
	                           error);
}

// Continues the session at its present tick after a failed rewind, with energy off.
static void stay(going *g)
{
	cau_hosted *h = g->hosted;
	cau_error error = {0};
	if (return_to_present(g, &error))
		cau_hosted_fault(h, &error);
	else
		cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_STAYED, .time_s = cau_monotonic_s()});
	cau_pace_restart(&h->pace, h->core.tick);
	h->frames.dirty = true;
}

// ---- the stages ---------------------------------------------------------------------------------

static cau_status read_past(going *g, cau_error *error)
{
	cau_hosted *h = g->hosted;
	end_gap(&h->record);
	cau_record_commit(h);
	cau_status status = cau_replay_check(&h->identity, &h->commits, g->branch,
	                                     g->branch == h->history.branch, g->tick, error);
	return status ? status
	              : cau_replay_read(&h->replay, h->identity.around->store, h->identity.id,
	                                g->branch, g->tick, error);
}

// Takes a snapshot of the present state. For a faulted session a failure is not an error.
static cau_status keep_present(going *g, cau_error *error)
{
	cau_hosted *h = g->hosted;
	size_t capacity = cau_session_snapshot_bytes(h->core.session);
	g->present = malloc(capacity);
	cau_status status =
		g->present
			? cau_session_snapshot(h->core.session, g->present, capacity, &g->present_bytes, error)
			: cau_fail(error, CAU_NO_MEMORY, "", "no memory to keep the present state");
	if (!status)
		return CAU_OK;
	free(g->present);
	g->present = NULL;
	return cau_decisions_state(&h->decisions) == CAU_SESSION_FAULTED ? CAU_OK : status;
}

static cau_status leave_present(going *g, cau_error *error)
{
	cau_hosted *h = g->hosted;
	cau_status status = keep_present(g, error);
	if (status)
		return status;
	g->left = true;
	status = cau_replay_restore(&h->replay, h->core.session, error);
	if (!status)
		h->core.tick = h->replay.tick;
	return status;
}

static cau_status replay_slice(cau_present_core *core, cau_replay *replay, bool *over,
                               cau_error *error)
{
	cau_status status = cau_replay_slice(replay, core->session, SLICE_S, over, error);
	core->tick = replay->tick;
	return status;
}

static double expected_s(const going *g)
{
	const cau_hosted *h = g->hosted;
	if (g->stage == READING)
		return READ_EXPECTED_S;
	if (g->stage == RESTORING)
		return RESTORED_VERTEX_S * h->core.info.vertex_count;
	return h->pace.piece_s > SLICE_S ? h->pace.piece_s : SLICE_S;
}

// Submits the next stage. Another thread may have the job at once, so this function does not use
// `g` after that.
static void go_on(going *g)
{
	g->job.expected_s = expected_s(g);
	cau_builder_submit(g->hosted->identity.around->builder, &g->job);
}

static void end(going *g)
{
	cau_hosted *h = g->hosted;
	cau_replay_finish(&h->replay);
	free(g->present);
	free(g);
	cau_suspension_name_stage(&h->suspension, "");
	cau_building_over(h);
	cau_hosted_release(h);
}

static void give_up(going *g, const cau_error *error)
{
	cau_hosted *h = g->hosted;
	if (h->suspension.destroyers)
		cau_hosted_end(h);
	if (!h->life.ended)
		stay(g);
	cau_answer_fail(g->order, error, h->life.drain_wanted ? CAU_RPC_DRAINING : 0);
	end(g);
}

static void tell_stage(cau_hosted *h, const char *stage)
{
	cau_suspension_name_stage(&h->suspension, stage);
	cau_hosted_publish_summary(h);
}

static void run(cau_job *job)
{
	going *g = (going *)job;
	cau_hosted *h = g->hosted;
	cau_error error = {0};
	bool over = true;
	cau_status status = cau_suspension_check(h, "was rewound", stage_names[g->stage], &error);
	tell_stage(h, stage_names[g->stage]);
	if (!status && g->stage == READING)
		status = read_past(g, &error);
	else if (!status && g->stage == RESTORING)
		status = leave_present(g, &error);
	else if (!status)
		status = replay_slice(&h->core, &h->replay, &over, &error);
	if (status) {
		give_up(g, &error);
		return;
	}
	g->stage += over;
	if (g->stage < STAGE_COUNT) {
		go_on(g);
		return;
	}
	arrive(h, g->branch, g->order);
	end(g);
}

static void drop(cau_job *job)
{
	give_up((going *)job, &cau_daemon_ends);
}

// ---- on the worker ------------------------------------------------------------------------------

cau_outcome_kind cau_apply_back(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	int64_t branch = h->history.branch;
	uint64_t tick = order->kind == CAU_ORDER_RESET ? h->history.first_tick : order->as.tick;
	if (order->kind == CAU_ORDER_RESTORE) {
		const cau_named_snapshot *snapshot = cau_history_find(&h->history, order->as.name);
		if (!snapshot)
			return cau_answer_refuse(order, CAU_NOT_FOUND, "params.name",
			                         "the session has no snapshot of this name");
		branch = snapshot->branch;
		tick = snapshot->tick;
	} else if (tick > h->core.tick) {
		return cau_answer_refuse(order, CAU_BAD_VALUE, "params.tick",
		                         "the tick is later than the session's present tick");
	}
	going *g = malloc(sizeof *g);
	if (!g)
		return cau_answer_refuse(order, CAU_NO_MEMORY, "", "no memory for the rewind");
	cau_timeline_end_cuts(&h->timeline);
	*g = (going){.job = {.run = run, .drop = drop, .expected_s = READ_EXPECTED_S},
	             .hosted = cau_hosted_share(h),
	             .order = order,
	             .branch = branch,
	             .tick = tick,
	             .present_tick = h->core.tick};
	h->suspension.job = &g->job;
	tell_stage(h, stage_names[READING]);
	return CAU_DONE;
}

// ---- forks --------------------------------------------------------------------------------------

// Runs on the builder while the session's slices continue.
static void make_fork(cau_read_job *job)
{
	cau_hosted *h = job->hosted;
	cau_error error = {0};
	if (cau_replay_check(&h->identity, &h->commits, job->branch, true, job->order->as.fork.tick,
	                     &error))
		cau_reply_fail(&job->order->reply, &error, 0);
	else
		h->identity.around->fork(h->identity.around->user, h, job->branch, job->order);
}

cau_outcome_kind cau_apply_fork(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	if (!order->as.fork.has_tick)
		order->as.fork.tick = h->core.tick;
	if (order->as.fork.tick > h->core.tick)
		return cau_answer_refuse(order, CAU_BAD_VALUE, "params.tick",
		                         "the tick is later than the session's present tick");
	if (order->as.fork.tick == h->core.tick)
		cau_record_checkpoint(&h->record, NULL, NULL);
	end_gap(&h->record);
	cau_reads_hand_over(h, order, make_fork, NULL, NULL, READ_EXPECTED_S);
	return CAU_DONE;
}

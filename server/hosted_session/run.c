// SPDX-License-Identifier: GPL-3.0-or-later
// One slice of a session on a worker: energy cut-offs, orders, one step, frames, the commit.
#include <math.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

// longest slice of session.step, s; then other sessions get the worker
#define STEPPING_SLICE_S 0.01
#define REPLAY_SLICE_S 0.008 // longest slice of a replay, s, so that other sessions keep realtime

static void step(cau_hosted *h)
{
	cau_error error = {0};
	cau_frame frame;
	double began_s = cau_monotonic_s(), began_cpu_s = cau_thread_cpu_s();
	cau_status status = cau_session_step(h->core.session, &error);
	h->pace.step_cost_s = cau_monotonic_s() - began_s;
	h->core.tick += !status;
	cau_decide_stepped(h, status ? error.reason : NULL);
	cau_pace_expect(&h->pace, cau_thread_cpu_s() - began_cpu_s);
	if (status) {
		cau_hosted_tell_fault(h, &error);
		return;
	}
	cau_session_frame(h->core.session, &frame);
	cau_pace_stepped(&h->pace, h->identity.around->times, &frame.statistics);
	cau_findings_note(h, &frame);
	cau_published_count(
		&h->published,
		&(cau_hosted_counts){.steps = 1,
	                         .step_seconds = h->pace.step_cost_s,
	                         .energy_gain_j = fmax(frame.statistics.energy_gain_j, 0),
	                         .contacts_left_out = frame.statistics.contacts_left_out,
	                         .touching_cut_short = frame.statistics.touching_cut_short,
	                         .resting = frame.statistics.resting});
}

// ---- the next act
static cau_outcome_kind act(cau_hosted *h, const cau_action *action)
{
	cau_order *order = (cau_order *)(uintptr_t)action->ticket;
	switch (action->act) {
	case CAU_ACT_REFUSE:
		cau_hosted_refuse_order(h, order, &action->error, action->code);
		return CAU_DONE;
	case CAU_ACT_LOOK:
		return cau_record_resend(h, order);
	case CAU_ACT_ORDER:
		return cau_hosted_apply(h, order, action);
	case CAU_ACT_CUT:
		cau_energy_cut(h, action);
		return CAU_DONE;
	case CAU_ACT_PAUSE:
		return cau_apply_pause(h, NULL, action);
	case CAU_ACT_STEPPED:
	case CAU_ACT_STEP_FAILED:
		cau_time_stepped(h, order, action->act == CAU_ACT_STEP_FAILED);
		return CAU_DONE;
	case CAU_ACT_NOTHING:
	case CAU_ACT_STEP:
		break;
	}
	return CAU_DONE;
}

// Reports that no commit is under way. A resend may have looked for its earlier order just before
// the commit of that order ended. Without this report the resend would wait for a further commit.
static void note_commits(cau_hosted *h)
{
	if (h->commits.under_way == 0)
		cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_COMMITTED, .time_s = cau_monotonic_s()});
}

// Carries out acts until one tick of the clock is done or no act is left. session.step runs as fast
// as possible, with a border for orders and energy cut-offs before each tick.
static void act_until_tick(cau_hosted *h)
{
	cau_action action;
	double end_s = cau_monotonic_s() + STEPPING_SLICE_S;
	while (!h->life.ended && !h->suspension.job) {
		cau_decide_next(h, &action);
		cau_fault_report_broken_rule(h);
		if (action.act == CAU_ACT_NOTHING)
			return;
		if (action.act == CAU_ACT_STEP && *h->decisions.odd_tool) {
			cau_fault_stop_unsound(h);
			continue;
		}
		if (action.act == CAU_ACT_STEP) {
			step(h);
			if (cau_decisions_state(&h->decisions) == CAU_SESSION_RUNNING) {
				cau_pace_measure(&h->pace, h->core.tick, h->core.info.step_s);
				return;
			}
			cau_frames_publish(h, cau_monotonic_s());
			// After the last requested tick the answer follows at once, so that it is in the same
			// commit.
			if (cau_monotonic_s() >= end_s && cau_decisions_now(&h->decisions).steps_left)
				return;
			continue;
		}
		cau_outcome_kind outcome = act(h, &action);
		cau_decide_done(h, outcome);
		if (outcome == CAU_POSTPONED)
			note_commits(h);
	}
}

static bool energy_is_on(cau_hosted_decisions *decisions)
{
	cau_drive drives[CAU_MAX_TOOLS];
	int32_t count = cau_decisions_drives(decisions, drives);
	bool on = false;
	for (int32_t i = 0; i < count; i++)
		on |= drives[i].energized;
	return on;
}

static void checkpoint_if_due(cau_hosted *h, double now_s)
{
	bool running = cau_decisions_state(&h->decisions) == CAU_SESSION_RUNNING;
	if (!cau_record_is_due(&h->record, running, energy_is_on(&h->decisions), now_s))
		return;
	cau_timeline_end_cuts(&h->timeline);
	cau_record_checkpoint(&h->record, NULL, NULL);
}

static void drain(cau_hosted *h)
{
	cau_timeline_end_cuts(&h->timeline);
	if (h->core.session && !h->creation.starting) {
		cau_reads_serve(h, cau_reads_note(&h->reads));
		if (h->core.tick != h->record.checkpoint_tick)
			cau_record_checkpoint(&h->record, NULL, NULL);
	}
	cau_record_commit(h);
	if (h->commits.under_way == 0)
		h->life.drained = true;
}

// Continues the replay after a restart or a fork.
static void go_on_replaying(cau_hosted *h)
{
	cau_error error = {0};
	bool over;
	cau_status status =
		cau_replay_slice(&h->replay, h->core.session, REPLAY_SLICE_S, &over, &error);
	h->core.tick = h->replay.tick;
	h->pace.stepped_s += h->replay.stepped_s;
	h->replay.stepped_s = 0;
	if (status)
		cau_hosted_fault(h, &error);
	else if (!over)
		return;
	cau_findings_know(&h->findings, h->core.session);
	h->creation.replaying = false;
	cau_hosted_started(h);
	cau_replay_finish(&h->replay);
}

static void serve(cau_hosted *h, double now_s)
{
	int32_t reads = cau_reads_note(&h->reads);
	act_until_tick(h);
	if (h->life.ended || h->suspension.job)
		return;
	cau_refusals_report(&h->refusals, &h->identity, now_s);
	cau_frames_publish(h, cau_monotonic_s());
	checkpoint_if_due(h, now_s);
	cau_reads_serve(h, reads);
	cau_past_views_tire(&h->past, now_s);
}

static cau_due when(cau_hosted *h)
{
	double now_s = cau_monotonic_s();
	if (h->life.ended || h->life.drain_wanted)
		return (cau_due){INFINITY, INFINITY, h->pace.piece_s};
	if (h->creation.starting)
		return (cau_due){0, now_s + 0.1, h->pace.piece_s}; // running sessions go first
	double due_s = cau_decisions_due_s(&h->decisions);
	cau_decided now = cau_decisions_now(&h->decisions);
	if (now.state == CAU_SESSION_RUNNING)
		return (cau_due){fmin(due_s, now.tick_s), now.tick_s + now.period_s, h->pace.piece_s};
	due_s = fmin(due_s, cau_past_views_due_s(&h->past));
	return (cau_due){cau_reads_wait(&h->reads) || h->frames.dirty ? 0 : due_s, now_s + 0.1,
	                 h->pace.piece_s};
}

// Gives the core's threads the priority of workers. The builder has created them with its own
// priority.
static void adopt(cau_present_core *core, const char *id)
{
	cau_error error = {0};
	core->adopted = true;
	if (cau_session_adopt(core->session, &error))
		cau_log(CAU_LOG_WARNING, id, "threads_not_adopted", "reason=\"%s\"", error.reason);
}

// Runs one slice. The first slice only adopts the core and steps nothing. So the pool knows the
// length of a step before the first step.
static void run_slice(cau_hosted *h)
{
	if (h->life.drain_wanted)
		drain(h);
	else if (!h->core.adopted)
		adopt(&h->core, h->identity.id);
	else if (h->creation.replaying)
		go_on_replaying(h);
	else
		serve(h, cau_monotonic_s());
}

// Runs one slice as a task of the pool. `suspension.active` must be read before `ended`. While
// `active` is set, the builder has the session, including `ended`. Once `active` is read as false,
// all changes of the builder are visible, so a session that has ended on the builder is not run. In
// the other order, the session might end and return between the two reads.
cau_due cau_hosted_run(cau_task *task)
{
	cau_hosted *h = (cau_hosted *)task;
	const cau_due away = {INFINITY, INFINITY, task->next.piece_s}; // keeps the present estimate
	if (h->suspension.active)
		return away;
	h->pace.stepped_s = 0;
	if (!h->life.ended)
		run_slice(h);
	if (h->life.ended)
		cau_hosted_refuse_rest(h);
	cau_hosted_end_slice(h);
	task->undivided_s = h->pace.stepped_s;
	if (!h->suspension.job)
		return when(h);
	cau_suspension_begin(&h->suspension, h->identity.around);
	return away;
}

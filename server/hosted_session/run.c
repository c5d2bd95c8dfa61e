// SPDX-License-Identifier: GPL-3.0-or-later
// One slice of a session on a worker: cuts, orders, one step, frames, the commit.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

#define FACTOR_WINDOW_S 1.0   // realtime_factor is over this
#define GAIN_MOST 0.01        // of a tick's energy: beyond it a gain is reported
#define PIECE_KEPT 0.9        // of the longest step, from each to the next
#define STEPPING_SLICE_S 0.01 // session.step runs so long before others get the worker
#define REPLAY_SLICE_S 0.008  // and so long a replay, so that other sessions keep their pace

enum {
	QUIET_DOUBLINGS = 6,    // an untouched session has a checkpoint every 64 checkpoint_s at least
	GAIN_QUIET_TICKS = 600, // after a report that energy was gained: one in ten seconds is enough
};

// ---- time
// Who pulls: the first whose jaws hold something.
static void note_tear(cau_hosted *h, const cau_frame *frame, int32_t torn)
{
	const cau_tool_state *puller = NULL;
	for (int32_t i = frame->tool_count - 1; i >= 0; i--)
		if (frame->tools[i].grasped_vertices)
			puller = &frame->tools[i];
	h->touched = true;
	cau_event_add(h, CAU_EVENT_TEAR, puller ? puller->name : NULL, NULL, torn, NULL);
}

static void note_cut(cau_hosted *h, const cau_frame *frame)
{
	const cau_statistics *now = &frame->statistics;
	int32_t torn = now->elements_torn - h->elements_torn;
	int32_t removed = now->elements_removed - h->elements_removed - torn;
	h->elements_removed = now->elements_removed;
	h->elements_torn = now->elements_torn;
	if (torn > 0)
		note_tear(h, frame, torn);
	if (removed <= 0)
		return;
	cau_drive drives[CAU_MAX_TOOLS];
	h->touched = true;
	const cau_drive *cutter = NULL;
	int32_t count = cau_decide_drives(h, drives);
	for (int32_t i = 0; i < count; i++)
		if (drives[i].lit)
			cutter = &drives[i];
	cau_event_add(h, CAU_EVENT_CUT, cutter ? cutter->tool : NULL,
	              cutter ? cutter->driver.name : NULL, removed, NULL);
}

// Once for each layer, until all of it is right again.
static void note_inverted(cau_hosted *h, const cau_statistics *now)
{
	for (int32_t i = 0; i < h->scene->layer_count; i++) {
		uint32_t bit = 1u << i;
		bool reported = h->inverted_layers & bit;
		h->inverted_layers &= now->long_inverted[i] ? UINT32_MAX : ~bit;
		if (!now->long_inverted[i] || reported)
			continue;
		h->inverted_layers |= bit;
		cau_event_add(h, CAU_EVENT_INVERTED, NULL, NULL, now->long_inverted[i],
		              h->scene->layers[i].name);
	}
}

static void note_gain(cau_hosted *h, const cau_statistics *now)
{
	char detail[64];
	bool again = h->tick < h->gain_tick || h->tick - h->gain_tick >= GAIN_QUIET_TICKS;
	if (!(now->energy_gain_j > GAIN_MOST * now->energy_scale_j) || (h->gain_tick && !again))
		return;
	h->gain_tick = h->tick;
	snprintf(detail, sizeof detail, "%.3g J in a tick that had %.3g J", now->energy_gain_j,
	         now->energy_scale_j);
	cau_event_add(h, CAU_EVENT_ENERGY_GAIN, NULL, NULL, 0, detail);
}

static void note_vessels(cau_hosted *h, const cau_frame *frame)
{
	for (int32_t i = 0; i < frame->vessel_count; i++) {
		const cau_vessel_state *vessel = frame->vessels[i];
		uint32_t before = h->vessel_flags[i], now = vessel->flags;
		h->vessel_flags[i] = now;
		if (now & ~before & CAU_VESSEL_SEALED)
			cau_event_add(h, CAU_EVENT_SEALED, NULL, NULL, 0, vessel->name);
		if ((now ^ before) & CAU_VESSEL_BLEEDS)
			cau_event_add(h,
			              now & CAU_VESSEL_BLEEDS ? CAU_EVENT_BLEEDING : CAU_EVENT_BLEEDING_STOPPED,
			              NULL, NULL, 0, vessel->name);
	}
}

static void note_refusals(cau_hosted *h, const cau_frame *frame)
{
	for (int32_t i = 0; i < frame->refusal_count; i++) {
		h->refused_commands++;
		cau_log(CAU_LOG_INFO, h->id, "refused_at_tick", "tick=%llu path=%s reason=\"%s\"",
		        (unsigned long long)h->tick, frame->refusals[i].path, frame->refusals[i].reason);
	}
}

static void measure_factor(cau_hosted *h, double now_s)
{
	double wall_s = now_s - h->window_s;
	if (wall_s < FACTOR_WINDOW_S)
		return;
	h->realtime_factor = (double)(h->tick - h->window_tick) * h->info.step_s / wall_s;
	h->window_s = now_s;
	h->window_tick = h->tick;
}

// How long a step may be, for the pool: the longest lately, forgotten over some ten steps.
static void expect_piece(cau_hosted *h, double took_s)
{
	h->stepped_s += took_s;
	h->piece_s = fmax(took_s, PIECE_KEPT * h->piece_s);
}

static void step(cau_hosted *h)
{
	cau_error error = {0};
	cau_frame frame;
	double began_s = cau_monotonic_s(), began_cpu_s = cau_thread_cpu_s();
	cau_status status = cau_session_step(h->core, &error);
	h->step_cost_s = cau_monotonic_s() - began_s;
	h->tick += !status;
	cau_decide_stepped(h, status ? error.reason : NULL);
	expect_piece(h, cau_thread_cpu_s() - began_cpu_s);
	if (status) {
		cau_hosted_tell_fault(h, &error);
		return;
	}
	cau_session_frame(h->core, &frame);
	cau_times_stepped(h, &frame.statistics);
	note_cut(h, &frame);
	note_inverted(h, &frame.statistics);
	note_gain(h, &frame.statistics);
	note_vessels(h, &frame);
	cau_event_settle(h);
	note_refusals(h, &frame);
	pthread_mutex_lock(&h->mutex);
	h->counts.steps++;
	h->counts.step_seconds += h->step_cost_s;
	h->counts.energy_gain_j += fmax(frame.statistics.energy_gain_j, 0);
	h->counts.contacts_left_out = frame.statistics.contacts_left_out;
	h->counts.touching_cut_short = frame.statistics.touching_cut_short;
	h->counts.resting = frame.statistics.resting;
	pthread_mutex_unlock(&h->mutex);
}

// The core would heat a tool that is not on by the machine's books. Nobody can say how that came
// about, so nothing of it goes on: all tools go dark, and the session is faulted, alone.
static void stop_unsound(cau_hosted *h)
{
	cau_error error = {0};
	cau_frame frame;
	cau_session_frame(h->core, &frame);
	for (int32_t i = 0; i < frame.tool_count; i++)
		cau_drive_darken(h, frame.tools[i].name);
	cau_drive_darken(h, h->odd_tool); // which may be still to be added
	cau_fail(&error, CAU_FAULTED, "", "tool %s had energy on without an enable that counts",
	         h->odd_tool);
	cau_log(CAU_LOG_ERROR, h->id, "energy_disagrees", "tick=%llu tool=%s",
	        (unsigned long long)h->tick, h->odd_tool);
	cau_decide_stepped(h, error.reason);
	cau_hosted_tell_fault(h, &error);
}

// A safety rule of the decisions was broken. They have faulted the session by themselves, and their
// cuts follow as ordinary acts.
static void report_broken_rule(cau_hosted *h)
{
	cau_error error = {0};
	char reason[320];
	if (!cau_decide_broken(h, reason, sizeof reason))
		return;
	cau_fail(&error, CAU_FAULTED, "", "%s", reason);
	cau_log(CAU_LOG_ERROR, h->id, "rule_broken", "tick=%llu rule=\"%s\"",
	        (unsigned long long)h->tick, reason);
	cau_hosted_tell_fault(h, &error);
}

// ---- what is to be done now
static cau_outcome_kind act(cau_hosted *h, const cau_action *action)
{
	cau_order *order = (cau_order *)(uintptr_t)action->ticket;
	switch (action->act) {
	case CAU_ACT_REFUSE:
		cau_hosted_refuse_order(h, order, &action->error, action->code);
		return CAU_DONE;
	case CAU_ACT_LOOK:
		return cau_hosted_look(h, order);
	case CAU_ACT_ORDER:
		return cau_hosted_apply(h, order, action);
	case CAU_ACT_CUT:
		cau_drive_do_cut(h, action);
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

// A resend whose first was committed while it was looked for must not wait for a commit to come.
static void note_commits(cau_hosted *h)
{
	if (h->commits == 0)
		cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_COMMITTED, .time_s = cau_monotonic_s()});
}

// Does what is decided, until a tick of the clock is over or nothing is left. session.step goes as
// fast as it can, with a border for orders and cuts before each tick.
static void act_until_tick(cau_hosted *h)
{
	cau_action action;
	double end_s = cau_monotonic_s() + STEPPING_SLICE_S;
	while (!h->ended && !h->leaving) {
		cau_decide_next(h, &action);
		report_broken_rule(h);
		if (action.act == CAU_ACT_NOTHING)
			return;
		if (action.act == CAU_ACT_STEP && *h->odd_tool) {
			stop_unsound(h);
			continue;
		}
		if (action.act == CAU_ACT_STEP) {
			step(h);
			if (cau_decided_state(h) == CAU_SESSION_RUNNING) {
				measure_factor(h, cau_monotonic_s());
				return;
			}
			cau_frames_publish(h, cau_monotonic_s());
			// After the last of the ticks that were asked for comes their answer, for the same
			// commit.
			if (cau_monotonic_s() >= end_s && cau_decided_now(h).steps_left)
				return;
			continue;
		}
		cau_outcome_kind outcome = act(h, &action);
		cau_decide_done(h, outcome);
		if (outcome == CAU_POSTPONED)
			note_commits(h);
	}
}

// Whether something happened since the last checkpoint that a restart would have to replay, or that
// a crash would take back: commands, energy, cuts.
static bool is_quiet(cau_hosted *h)
{
	cau_drive drives[CAU_MAX_TOOLS];
	int32_t count = cau_decide_drives(h, drives);
	bool lit = false;
	for (int32_t i = 0; i < count; i++)
		lit |= drives[i].lit;
	return !lit && !h->touched;
}

static bool store_is_ready(cau_hosted *h)
{
	cau_store_health health;
	cau_store_get_health(h->around->store, &health);
	return health.state == CAU_STORE_READY;
}

// A checkpoint ends what a restart would have to replay. With nothing to replay each comes twice as
// late as the one before: a crash of a session that nobody touches takes it back by no more than
// the time that it was left alone.
static void checkpoint_if_due(cau_hosted *h, double now_s)
{
	bool quiet = is_quiet(h);
	int32_t doublings = quiet ? h->quiet_checkpoints : 0;
	double pause_s = ldexp(h->around->config->checkpoint_s, doublings);
	bool due = cau_decided_state(h) == CAU_SESSION_RUNNING && h->tick != h->checkpoint_tick &&
	           now_s - h->checkpoint_s >= pause_s;
	// A store without room is not tried: once it has room again it asks for a checkpoint.
	if ((due || h->checkpoint_wanted) && store_is_ready(h)) {
		cau_event_end_cut(h);
		cau_record_checkpoint(h, NULL, NULL);
	}
	if (!quiet)
		h->quiet_checkpoints = 0;
	else if (due && h->quiet_checkpoints < QUIET_DOUBLINGS)
		h->quiet_checkpoints++;
}

static void drain(cau_hosted *h)
{
	cau_event_end_cut(h);
	if (h->core && !h->starting) {
		cau_reads_serve(h, cau_reads_note(h));
		if (h->tick != h->checkpoint_tick)
			cau_record_checkpoint(h, NULL, NULL);
	}
	cau_record_commit(h);
	if (h->commits == 0)
		h->drained = true;
}

// After a restart or a fork.
static void go_on_replaying(cau_hosted *h)
{
	cau_error error = {0};
	bool over;
	cau_status status = cau_replay_slice(&h->replay, h->core, REPLAY_SLICE_S, &over, &error);
	h->tick = h->replay.tick;
	h->stepped_s += h->replay.stepped_s;
	h->replay.stepped_s = 0;
	if (status)
		cau_hosted_fault(h, &error);
	else if (!over)
		return;
	cau_event_know_tissue(h);
	h->replaying = false;
	cau_hosted_started(h);
	cau_replay_finish(&h->replay);
}

static void serve(cau_hosted *h, double now_s)
{
	int32_t reads = cau_reads_note(h);
	act_until_tick(h);
	if (h->ended || h->leaving)
		return;
	cau_drive_tell_refusals(h, now_s);
	cau_frames_publish(h, cau_monotonic_s());
	checkpoint_if_due(h, now_s);
	cau_reads_serve(h, reads);
	cau_looks_tire(h, now_s);
}

static cau_due when(cau_hosted *h)
{
	double now_s = cau_monotonic_s();
	if (h->ended || h->drain_wanted)
		return (cau_due){INFINITY, INFINITY, h->piece_s};
	if (h->starting)
		return (cau_due){0, now_s + 0.1, h->piece_s}; // those at wall rate go first
	pthread_mutex_lock(&h->deciding);
	double due_s = cau_logic_due_s(h->logic), tick_s = h->logic->next_step_s;
	double period_s = h->logic->step_s / h->logic->speed;
	pthread_mutex_unlock(&h->deciding);
	if (cau_decided_state(h) == CAU_SESSION_RUNNING)
		return (cau_due){fmin(due_s, tick_s), tick_s + period_s, h->piece_s};
	due_s = fmin(due_s, cau_looks_due_s(h));
	return (cau_due){cau_reads_wait(h) || h->dirty ? 0 : due_s, now_s + 0.1, h->piece_s};
}

// The builder made the core, and its threads have the builder's priority: they become a worker's.
static void adopt(cau_hosted *h)
{
	cau_error error = {0};
	h->adopted = true;
	if (cau_session_adopt(h->core, &error))
		cau_log(CAU_LOG_WARNING, h->id, "threads_not_adopted", "reason=\"%s\"", error.reason);
}

// The first slice steps nothing: by its end the pool knows how long a step may be.
static void run_slice(cau_hosted *h)
{
	if (h->drain_wanted)
		drain(h);
	else if (!h->adopted)
		adopt(h);
	else if (h->replaying)
		go_on_replaying(h);
	else
		serve(h, cau_monotonic_s());
}

// `away` is looked at first. Until the builder gives the session back it is the builder's, `ended`
// and all; what the builder did before is seen once `away` is seen to be false, so that no session
// which has ended there is run. In the other order it may end and be given back between the two.
cau_due cau_hosted_run(cau_task *task)
{
	cau_hosted *h = (cau_hosted *)task;
	const cau_due away = {INFINITY, INFINITY, task->next.piece_s}; // as it was
	if (h->away)
		return away;
	h->stepped_s = 0;
	if (!h->ended)
		run_slice(h);
	if (h->ended)
		cau_hosted_refuse_rest(h);
	cau_hosted_end_slice(h);
	task->undivided_s = h->stepped_s;
	if (!h->leaving)
		return when(h);
	cau_back_leave(h);
	return away;
}

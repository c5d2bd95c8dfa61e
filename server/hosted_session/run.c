// SPDX-License-Identifier: GPL-3.0-or-later
// One slice of a session on a worker: cuts, orders, one step, frames, the commit.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

#define BEHIND_MOST_S 0.25    // more than this behind the wall is given up, not caught up
#define FACTOR_WINDOW_S 1.0   // realtime_factor is over this
#define STEPPING_SLICE_S 0.01 // session.step runs so long before others get the worker

enum {
	QUIET_DOUBLINGS = 6
}; // an untouched session has a checkpoint every 64 checkpoint_s at least

void cau_hosted_set_fault(cau_hosted *h, const cau_error *error)
{
	cau_wire_session_faulted params = {.tick = (int64_t)h->tick};
	h->state = CAU_SESSION_FAULTED;
	h->steps_left = 0;
	snprintf(h->fault, sizeof h->fault, "%s", error->reason);
	snprintf(params.session, sizeof params.session, "%s", h->id);
	snprintf(params.reason, sizeof params.reason, "%.319s", error->reason);
	cau_event_add(h, CAU_EVENT_FAULT, NULL, NULL, 0, h->fault);
	cau_answer_notify(h, (cau_audience){CAU_AUDIENCE_SESSION, h->number},
	                  CAU_METHOD_SESSION_FAULTED, &params);
	h->dirty = true;
	if (h->stepping) {
		cau_answer_fail(h->stepping, error, CAU_RPC_FAULTED);
		h->stepping = NULL;
	}
}

void cau_hosted_publish_summary(cau_hosted *h)
{
	cau_wire_session_summary now = {
		.state = h->starting ? CAU_SESSION_STARTING : h->state,
		.tick = (int64_t)h->tick,
		.time_s = (double)h->tick * h->scene->step_s,
		.step_s = h->scene->step_s,
		.speed = h->speed,
		.realtime_factor = h->realtime_factor,
		.vertex_count = h->info.vertex_count,
		.face_count = h->info.face_count,
		.tool_count = h->drive_count,
		.epoch = h->epoch,
		.has_fault = h->state == CAU_SESSION_FAULTED && *h->fault,
	};
	memcpy(now.session, h->id, sizeof now.session);
	memcpy(now.scene, h->scene->name, sizeof now.scene);
	snprintf(now.fault, sizeof now.fault, "%.319s", h->fault);
	pthread_mutex_lock(&h->mutex);
	h->summary = now;
	h->counts.realtime_factor = h->realtime_factor;
	pthread_mutex_unlock(&h->mutex);
}

// ---- orders
static cau_order *take_orders(cau_hosted *h)
{
	pthread_mutex_lock(&h->mutex);
	cau_order *orders = h->first;
	h->first = h->last = NULL;
	h->queued = 0;
	pthread_mutex_unlock(&h->mutex);
	return orders;
}

static void put_back(cau_hosted *h, cau_order *orders)
{
	cau_order *last = orders;
	int32_t count = 1;
	for (; last->next; last = last->next)
		count++;
	pthread_mutex_lock(&h->mutex);
	last->next = h->first;
	h->first = orders;
	if (!h->last)
		h->last = last;
	h->queued += count;
	pthread_mutex_unlock(&h->mutex);
}

static void refuse_all(cau_order *orders)
{
	cau_error error = {.status = CAU_NOT_FOUND, .reason = "the session is destroyed"};
	for (cau_order *next; orders; orders = next) {
		next = orders->next;
		cau_answer_fail(orders, &error, CAU_RPC_NOT_HERE);
	}
}

static void apply_orders(cau_hosted *h)
{
	cau_order *again = h->postponed;
	if (again && h->commits == 0) {
		h->postponed = NULL;
		h->commit_awaited = false;
		put_back(h, again);
	}
	cau_order *orders = take_orders(h);
	while (orders && !h->replay.active && !h->ended) {
		cau_order *order = orders;
		orders = order->next;
		order->next = NULL;
		cau_hosted_apply(h, order);
	}
	if (orders && h->ended)
		refuse_all(orders);
	else if (orders)
		put_back(h, orders);
}

// ---- time
static void note_cut(cau_hosted *h, const cau_frame *frame)
{
	int32_t removed = frame->statistics.elements_removed - h->elements_removed;
	h->elements_removed = frame->statistics.elements_removed;
	if (removed <= 0)
		return;
	h->touched = true;
	const cau_drive *cutter = NULL;
	for (int32_t i = 0; i < h->drive_count; i++)
		if (h->drives[i].energized)
			cutter = &h->drives[i];
	cau_event_add(h, CAU_EVENT_CUT, cutter ? cutter->tool : NULL,
	              cutter ? cutter->driver.name : NULL, removed, NULL);
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

static void step(cau_hosted *h)
{
	cau_error error = {0};
	cau_frame frame;
	double began_s = cau_monotonic_s();
	cau_status status = cau_session_step(h->core, &error);
	h->step_cost_s = cau_monotonic_s() - began_s;
	if (status) {
		cau_hosted_set_fault(h, &error);
		return;
	}
	h->tick++;
	cau_session_frame(h->core, &frame);
	note_cut(h, &frame);
	cau_event_settle(h);
	note_refusals(h, &frame);
	pthread_mutex_lock(&h->mutex);
	h->counts.steps++;
	h->counts.step_seconds += h->step_cost_s;
	pthread_mutex_unlock(&h->mutex);
}

static void run_clock(cau_hosted *h, double now_s)
{
	if (h->state != CAU_SESSION_RUNNING || now_s < h->next_step_s)
		return;
	double period_s = h->info.step_s / h->speed;
	h->next_step_s += period_s;
	if (now_s - h->next_step_s > fmax(BEHIND_MOST_S, period_s))
		h->next_step_s = now_s;
	step(h);
	measure_factor(h, cau_monotonic_s());
}

// session.step: as fast as it goes, a border for orders and cuts after each slice.
static void run_stepping(cau_hosted *h)
{
	double end_s = cau_monotonic_s() + STEPPING_SLICE_S;
	while (h->steps_left > 0 && h->state == CAU_SESSION_PAUSED) {
		h->steps_left--;
		step(h);
		cau_streams_publish(h, cau_monotonic_s());
		if (cau_monotonic_s() >= end_s)
			break;
	}
	if (h->steps_left == 0 && h->stepping) {
		cau_wire_tick_result result = {(int64_t)h->tick, 0};
		cau_order *order = h->stepping;
		h->stepping = NULL;
		cau_event_end_cut(h);
		h->dirty = true; // the last state is shown, whatever the streams' rates
		cau_record_checkpoint(h, NULL, NULL);
		cau_answer_changed(h, CAU_CHANGE_STEPPED, order->asker.name);
		cau_answer_order(h, order, &result);
	}
}

// Whether something happened since the last checkpoint that a restart would have to replay, or that
// a crash would take back: commands, energy, cuts.
static bool is_quiet(cau_hosted *h)
{
	bool lit = false;
	for (int32_t i = 0; i < h->drive_count; i++)
		lit |= h->drives[i].energized;
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
	bool due = h->state == CAU_SESSION_RUNNING && h->tick != h->checkpoint_tick &&
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
	if (h->core && !h->starting && h->tick != h->checkpoint_tick)
		cau_record_checkpoint(h, NULL, NULL);
	cau_record_commit(h);
	h->commit_awaited = true;
	if (h->commits == 0)
		h->drained = true;
}

static void go_on_replaying(cau_hosted *h)
{
	if (cau_replay_slice(h))
		return;
	cau_order *order = h->replay.order;
	cau_frame frame;
	cau_session_frame(h->core, &frame);
	h->elements_removed = frame.statistics.elements_removed;
	if (!order) {
		cau_hosted_started(h);
	} else if (h->state == CAU_SESSION_FAULTED && h->tick < h->replay.until) {
		cau_error error = {.status = CAU_FAULTED};
		snprintf(error.reason, sizeof error.reason, "%s", h->fault);
		cau_answer_fail(order, &error, 0);
	} else {
		cau_back_arrived(h, order);
	}
	cau_replay_finish(&h->replay);
}

static void serve(cau_hosted *h, double now_s)
{
	int32_t reads = cau_reads_note(h);
	cau_drive_apply_cuts(h);
	apply_orders(h);
	if (h->ended || h->replay.active)
		return;
	run_clock(h, now_s);
	run_stepping(h);
	cau_drive_tell_refusals(h, now_s);
	cau_streams_publish(h, cau_monotonic_s());
	checkpoint_if_due(h, now_s);
	cau_reads_serve(h, reads);
}

static bool has_orders(cau_hosted *h)
{
	pthread_mutex_lock(&h->mutex);
	bool any = h->first != NULL;
	pthread_mutex_unlock(&h->mutex);
	return any;
}

static cau_due when(cau_hosted *h)
{
	double now_s = cau_monotonic_s();
	if (h->ended || h->drain_wanted)
		return (cau_due){INFINITY, INFINITY};
	if (h->starting || h->replay.active || h->steps_left)
		return (cau_due){0, now_s + 0.1}; // those at wall rate go first
	if (h->state == CAU_SESSION_RUNNING)
		return (cau_due){h->next_step_s, h->next_step_s + h->info.step_s / h->speed};
	bool wanted = has_orders(h) || cau_reads_wait(h) || h->dirty;
	return (cau_due){wanted ? 0 : INFINITY, now_s + 0.1};
}

cau_due cau_hosted_run(cau_task *task)
{
	cau_hosted *h = (cau_hosted *)task;
	if (h->ended)
		return (cau_due){INFINITY, INFINITY};
	if (h->drain_wanted)
		drain(h);
	else if (!h->core)
		cau_hosted_start(h);
	else if (h->replay.active)
		go_on_replaying(h);
	else
		serve(h, cau_monotonic_s());
	cau_record_commit(h);
	if (!h->starting)
		h->unanswered = false;
	cau_hosted_publish_summary(h);
	cau_hosted_publish_tools(h);
	h->around->sink.sliced(h->around->sink.user);
	return when(h);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Computes views of past ticks. A view rewinds no session, and no worker waits for it: a second
// core (past_core.c) goes to the tick on the builder, alternating with other jobs. A session has
// one such core, and requests wait for it in a queue, one for each client. A client's new request
// cancels the client's previous request. Between two turns a request is dropped if its client has
// cancelled it or is gone, or if the session has ended.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/sha256.h"
#include "hosted_session/internal.h"
#include "hosted_session/life.h"
#include "hosted_session/slice.h"

// Estimated times of the stages, s, and s for each vertex. The builder sorts its jobs by them, as
// in rewind.c.
#define READ_EXPECTED_S 0.02
#define RESTORED_VERTEX_S 6e-6
#define SLICE_S 0.1 // length of one turn of a replay, s; after each turn other short jobs may run

// Time, s, after which an unused core is freed, because it takes as much memory as the session's
// own core.
#define KEPT_S 60.0

// ---- answers ------------------------------------------------------------------------------------
static cau_stream_def define(const cau_hosted_identity *identity, const cau_session_info *info,
                             const cau_order *order)
{
	cau_stream_def def = cau_default_stream_def();
	def.session = identity->number;
	def.channels = order->as.frame_at.channels;
	def.vertex_count = info->vertex_count;
	def.face_count = info->face_count;
	def.step_m = order->as.frame_at.step_m;
	def.plain = order->as.frame_at.plain;
	return def;
}

static void describe(const cau_past_views *views, const cau_stream_def *def, size_t byte_count,
                     cau_wire_past_frame *result)
{
	const cau_hosted *h = views->hosted;
	const cau_replay *replay = &views->core.replay;
	*result = (cau_wire_past_frame){.transfer = cau_export_number(),
	                                .byte_count = (int64_t)byte_count,
	                                .tick = (int64_t)replay->tick,
	                                .exact = replay->exact,
	                                .session_number = h->identity.number,
	                                .epoch = views->present->as.frame_at.epoch,
	                                .channels = def->channels,
	                                .vertex_count = def->vertex_count,
	                                .face_count = def->face_count,
	                                .step_m = def->step_m,
	                                .stress_step_pa = def->stress_step_pa};
	memcpy(result->origin_m, def->origin_m, sizeof result->origin_m);
	snprintf(result->file_name, sizeof result->file_name, "%s-%llu.cauf", h->identity.id,
	         (unsigned long long)replay->tick);
	snprintf(result->media_type, sizeof result->media_type, "application/octet-stream");
}

static cau_status answer(cau_past_views *views, cau_error *error)
{
	cau_order *order = views->present;
	cau_stream_def def = define(&views->hosted->identity, &views->hosted->core.info, order);
	cau_wire_past_frame result;
	cau_buffer *frame = cau_past_core_frame(&views->core, &def, order->as.frame_at.epoch, error);
	if (!frame)
		return error->status;
	describe(views, &def, frame->byte_count, &result);
	cau_outcome outcome = {.file = frame, .transfer = (uint32_t)result.transfer};
	char *text = NULL;
	if (cau_sha256(cau_buffer_bytes(frame), frame->byte_count, result.sha256))
		text = cau_answer_text(order->reply.method, &result, &outcome.text_bytes, error);
	else
		cau_fail(error, CAU_NO_MEMORY, "", "no memory for the frame's hash");
	outcome.text = text;
	if (text)
		cau_reply_answer(&order->reply, &outcome);
	cau_buffer_release(frame);
	free(text);
	return text ? CAU_OK : error->status;
}

static void tell_progress(cau_past_views *views)
{
	cau_hosted *h = views->hosted;
	const cau_order *order = views->present;
	const cau_replay *replay = &views->core.replay;
	bool on_the_way = views->stage == CAU_LOOK_REPLAYING;
	cau_wire_frame_progress progress = {.tick = (int64_t)order->as.frame_at.tick,
	                                    .stage = (int32_t)views->stage,
	                                    .from_tick = on_the_way ? (int64_t)replay->from : 0,
	                                    .at_tick = on_the_way ? (int64_t)replay->tick : 0};
	memcpy(progress.session, h->identity.id, sizeof progress.session);
	cau_answer_notify(&h->identity, (cau_audience){CAU_AUDIENCE_CLIENT, order->asker.client},
	                  CAU_METHOD_SESSION_FRAME_PROGRESS, &progress);
}

// ---- the queue ----------------------------------------------------------------------------------
// Makes the next waiting request the present one. Returns false if none waits; then the builder
// releases the views. Another thread of the builder may have the views as soon as the lock is
// released, so this function reads nothing of the views after that.
static bool take_next(cau_past_views *views)
{
	pthread_mutex_lock(&views->lock);
	views->present = views->waiting;
	views->given_up = false;
	bool taken = views->present != NULL;
	if (taken)
		views->waiting = views->present->next;
	else
		views->busy = false;
	views->idle_since_s = cau_monotonic_s();
	pthread_mutex_unlock(&views->lock);
	return taken;
}

static void drop_present(cau_past_views *views, const cau_error *error, int32_t code)
{
	pthread_mutex_lock(&views->lock);
	cau_order *order = views->present;
	views->present = NULL;
	pthread_mutex_unlock(&views->lock);
	if (error)
		cau_reply_fail(&order->reply, error, code);
	free(order);
}

// ---- the stages ---------------------------------------------------------------------------------
static cau_status check(void *user, cau_error *error)
{
	cau_past_views *views = user;
	cau_hosted *h = views->hosted;
	if (h->life.ended)
		return cau_fail(error, CAU_NOT_FOUND, "", "the session is gone");
	if (h->life.drain_wanted)
		return cau_fail(error, CAU_BAD_STATE, "", "the daemon is ending");
	pthread_mutex_lock(&views->lock);
	bool given_up = views->given_up;
	pthread_mutex_unlock(&views->lock);
	if (given_up)
		return cau_fail(
			error, CAU_BAD_STATE, "",
			"cancelled on the way: the client asked for another past view, or cancelled this one");
	return CAU_OK;
}

static double expected_s(const cau_past_views *views)
{
	const cau_hosted *h = views->hosted;
	if (!views->present || views->stage == CAU_LOOK_READING)
		return READ_EXPECTED_S;
	if (views->stage == CAU_LOOK_BUILDING)
		return cau_building_expects_s(h->identity.scene);
	return views->stage == CAU_LOOK_RESTORING ? RESTORED_VERTEX_S * h->core.info.vertex_count
	                                          : SLICE_S;
}

static void go_on(cau_past_views *views)
{
	views->job.expected_s = expected_s(views);
	cau_builder_submit(views->hosted->identity.around->builder, &views->job);
}

static cau_status do_stage(cau_past_views *views, bool *over, cau_error *error)
{
	cau_past_core *past = &views->core;
	const cau_order *order = views->present;
	switch (views->stage) {
	case CAU_LOOK_BUILDING:
		return past->session ? CAU_OK : cau_past_core_build(past, check, views, error);
	case CAU_LOOK_READING:
		return cau_past_core_read(past, order->as.frame_at.branch, order->as.frame_at.tick, error);
	case CAU_LOOK_RESTORING:
		return cau_past_core_restore(past, error);
	default:
		return cau_past_core_slice(past, SLICE_S, over, error);
	}
}

static int32_t code_of(const cau_hosted_life *life)
{
	return life->ended ? CAU_RPC_NOT_HERE : life->drain_wanted ? CAU_RPC_DRAINING : 0;
}

// Runs one stage of the present request, or one turn of its replay.
static void advance(cau_past_views *views)
{
	cau_error error = {0};
	bool over = true;
	cau_status status = check(views, &error);
	if (!status) {
		tell_progress(views);
		status = do_stage(views, &over, &error);
	}
	views->stage += over;
	bool done = views->stage == CAU_LOOK_STAGE_COUNT;
	if (!status && done)
		status = answer(views, &error);
	if (status || done)
		drop_present(views, status ? &error : NULL, code_of(&views->hosted->life));
}

static void let_go(cau_past_views *views)
{
	cau_hosted *h = views->hosted;
	// the worker frees the unused core later
	cau_worker_pool_wake(h->identity.around->pool, &h->task);
	cau_hosted_release(h);
}

// Runs on the builder, which has the core while `busy` is set.
static void run(cau_job *job)
{
	cau_past_views *views = (cau_past_views *)job;
	if (views->tired)
		cau_past_core_finish(&views->core);
	views->tired = false;
	if (views->present) {
		advance(views);
	} else if (take_next(views)) {
		views->stage = CAU_LOOK_BUILDING;
	} else {
		let_go(views);
		return;
	}
	go_on(views);
}

// Drops all requests because the builder ends.
static void drop(cau_job *job)
{
	cau_past_views *views = (cau_past_views *)job;
	do {
		if (views->present)
			drop_present(views, &cau_daemon_ends, CAU_RPC_DRAINING);
	} while (take_next(views));
	cau_hosted_release(views->hosted);
}

// ---- on the worker ------------------------------------------------------------------------------
void cau_past_views_init(cau_past_views *views, cau_hosted *h)
{
	views->job = (cau_job){.run = run, .drop = drop};
	views->hosted = h;
	views->core.identity = &h->identity;
	views->core.commits = &h->commits;
	pthread_mutex_init(&views->lock, NULL);
}

// Submits the job to the builder, unless the builder has it already.
static void wake(cau_past_views *views, bool was_busy)
{
	if (was_busy)
		return;
	cau_hosted_share(views->hosted);
	views->job.expected_s = READ_EXPECTED_S;
	cau_builder_submit(views->core.identity->around->builder, &views->job);
}

static void line_up(cau_past_views *views, cau_order *order)
{
	pthread_mutex_lock(&views->lock);
	cau_order_append(&views->waiting, order);
	bool was_busy = views->busy;
	views->busy = true;
	pthread_mutex_unlock(&views->lock);
	wake(views, was_busy);
}

void cau_apply_frame_at(cau_hosted *h, cau_order *order)
{
	uint64_t epoch = h->frames.epoch;
	if (order->as.frame_at.tick > h->core.tick) {
		cau_answer_refuse(order, CAU_BAD_VALUE, "params.tick",
		                  "the tick is later than the session's present tick");
		return;
	}
	order->as.frame_at.branch = h->history.branch;
	order->as.frame_at.epoch = epoch == UINT64_MAX ? 1 : ~epoch; // an epoch that no stream has
	cau_record_commit(h); // submits the records that the builder will read from the store
	cau_past_views_give_up(&h->past, order->asker.client);
	line_up(&h->past, order);
}

void cau_apply_frame_cancel(cau_hosted *h, cau_order *order)
{
	cau_past_views_give_up(&h->past, order->asker.client);
	cau_answer_order(&h->record, order, &(cau_wire_nothing){0});
}

// Returns the time at which the core must be freed. Call this under the lock.
static double tires_s(const cau_past_views *views)
{
	return !views->busy && views->core.session ? views->idle_since_s + KEPT_S : INFINITY;
}

double cau_past_views_due_s(cau_past_views *views)
{
	pthread_mutex_lock(&views->lock);
	double due_s = tires_s(views);
	pthread_mutex_unlock(&views->lock);
	return due_s;
}

void cau_past_views_tire(cau_past_views *views, double now_s)
{
	pthread_mutex_lock(&views->lock);
	bool tired = now_s >= tires_s(views);
	if (tired)
		views->busy = views->tired = true;
	pthread_mutex_unlock(&views->lock);
	if (tired)
		wake(views, false);
}

// ---- from any thread ----------------------------------------------------------------------------

// Removes the client's request from the queue, or returns NULL. Call this under the lock.
static cau_order *take_of_client(cau_past_views *views, uint32_t client)
{
	cau_order **place = &views->waiting;
	while (*place && (*place)->asker.client != client)
		place = &(*place)->next;
	cau_order *order = *place;
	if (order)
		*place = order->next;
	return order;
}

void cau_past_views_give_up(cau_past_views *views, uint32_t client)
{
	pthread_mutex_lock(&views->lock);
	cau_order *order = take_of_client(views, client);
	if (views->present && views->present->asker.client == client)
		views->given_up = true;
	pthread_mutex_unlock(&views->lock);
	if (order)
		cau_answer_refuse(order, CAU_BAD_STATE, "",
		                  "cancelled before it began: the client asked for another past view, or "
		                  "cancelled this one");
}

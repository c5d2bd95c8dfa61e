// SPDX-License-Identifier: GPL-3.0-or-later
// session.frame_at: what a session looked like at a tick, for one who asks. Nobody is rewound and
// no worker waits: a second core (past.c) goes there on the builder, in turns. A session has one
// such core, and looks wait for it in line, one for each client: who asks anew gives up the one
// before. Between turns who has given up, is gone, or has no session any more is let go.
#include <stdlib.h>
#include <string.h>

#include "cautery/sha256.h"
#include "hosted_session/looks.h"

// What the stages take, for the builder's order (back.c).
#define READ_EXPECTED_S 0.02
#define RESTORED_VERTEX_S 6e-6
#define SLICE_S 0.1 // of a replay, before other short jobs have their turn

// ---- answers ------------------------------------------------------------------------------------
static cau_stream_def define(const cau_hosted *h, const cau_order *order)
{
	cau_stream_def def = cau_default_stream_def();
	def.session = h->number;
	def.channels = order->as.frame_at.channels;
	def.vertex_count = h->info.vertex_count;
	def.face_count = h->info.face_count;
	def.step_m = order->as.frame_at.step_m;
	def.plain = order->as.frame_at.plain;
	return def;
}

static void describe(const cau_looks *looks, const cau_stream_def *def, size_t byte_count,
                     cau_wire_past_frame *result)
{
	const cau_hosted *h = looks->hosted;
	const cau_replay *replay = &looks->past.replay;
	*result = (cau_wire_past_frame){.transfer = cau_export_number(),
	                                .byte_count = (int64_t)byte_count,
	                                .tick = (int64_t)replay->tick,
	                                .exact = replay->exact,
	                                .session_number = h->number,
	                                .epoch = looks->present->as.frame_at.epoch,
	                                .channels = def->channels,
	                                .vertex_count = def->vertex_count,
	                                .face_count = def->face_count,
	                                .step_m = def->step_m,
	                                .stress_step_pa = def->stress_step_pa};
	memcpy(result->origin_m, def->origin_m, sizeof result->origin_m);
	snprintf(result->file_name, sizeof result->file_name, "%s-%llu.cauf", h->id,
	         (unsigned long long)replay->tick);
	snprintf(result->media_type, sizeof result->media_type, "application/octet-stream");
}

static cau_status answer(cau_looks *looks, cau_error *error)
{
	cau_order *order = looks->present;
	cau_stream_def def = define(looks->hosted, order);
	cau_wire_past_frame result;
	cau_buffer *frame = cau_past_frame(&looks->past, &def, order->as.frame_at.epoch, error);
	if (!frame)
		return error->status;
	describe(looks, &def, frame->byte_count, &result);
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

static void tell_progress(cau_looks *looks)
{
	cau_hosted *h = looks->hosted;
	const cau_order *order = looks->present;
	const cau_replay *replay = &looks->past.replay;
	bool on_the_way = looks->stage == CAU_LOOK_REPLAYING;
	cau_wire_frame_progress progress = {.tick = (int64_t)order->as.frame_at.tick,
	                                    .stage = (int32_t)looks->stage,
	                                    .from_tick = on_the_way ? (int64_t)replay->from : 0,
	                                    .at_tick = on_the_way ? (int64_t)replay->tick : 0};
	memcpy(progress.session, h->id, sizeof progress.session);
	cau_answer_notify(h, (cau_audience){CAU_AUDIENCE_CLIENT, order->asker.client},
	                  CAU_METHOD_SESSION_FRAME_PROGRESS, &progress);
}

// ---- the line -----------------------------------------------------------------------------------
// The next that waits, as the present one. False: there is none, and the builder lets go; from the
// mutex's release on another of its threads may have the looks, so nothing of them is read then.
static bool take_next(cau_looks *looks)
{
	cau_hosted *h = looks->hosted;
	pthread_mutex_lock(&h->mutex);
	looks->present = looks->waiting;
	looks->given_up = false;
	bool taken = looks->present != NULL;
	if (taken)
		looks->waiting = looks->present->next;
	else
		looks->busy = false;
	looks->idle_since_s = cau_monotonic_s();
	pthread_mutex_unlock(&h->mutex);
	return taken;
}

static void drop_present(cau_looks *looks, const cau_error *error, int32_t code)
{
	cau_hosted *h = looks->hosted;
	pthread_mutex_lock(&h->mutex);
	cau_order *order = looks->present;
	looks->present = NULL;
	pthread_mutex_unlock(&h->mutex);
	if (error)
		cau_reply_fail(&order->reply, error, code);
	free(order);
}

// ---- the stages ---------------------------------------------------------------------------------
static cau_status check(void *user, cau_error *error)
{
	cau_looks *looks = user;
	cau_hosted *h = looks->hosted;
	if (h->ended)
		return cau_fail(error, CAU_NOT_FOUND, "", "the session is gone");
	if (h->drain_wanted)
		return cau_fail(error, CAU_BAD_STATE, "", "the daemon is ending");
	pthread_mutex_lock(&h->mutex);
	bool given_up = looks->given_up;
	pthread_mutex_unlock(&h->mutex);
	if (given_up)
		return cau_fail(
			error, CAU_BAD_STATE, "",
			"cancelled on the way: the client asked for another past view, or cancelled this one");
	return CAU_OK;
}

static double expected_s(const cau_looks *looks)
{
	const cau_hosted *h = looks->hosted;
	if (!looks->present || looks->stage == CAU_LOOK_READING)
		return READ_EXPECTED_S;
	if (looks->stage == CAU_LOOK_BUILDING)
		return cau_building_expects_s(h->scene);
	return looks->stage == CAU_LOOK_RESTORING ? RESTORED_VERTEX_S * h->info.vertex_count : SLICE_S;
}

static void go_on(cau_looks *looks)
{
	looks->job.expected_s = expected_s(looks);
	cau_builder_submit(looks->hosted->around->builder, &looks->job);
}

static cau_status do_stage(cau_looks *looks, bool *over, cau_error *error)
{
	cau_past *past = &looks->past;
	const cau_order *order = looks->present;
	switch (looks->stage) {
	case CAU_LOOK_BUILDING:
		return past->core ? CAU_OK : cau_past_build(past, check, looks, error);
	case CAU_LOOK_READING:
		return cau_past_read(past, order->as.frame_at.branch, order->as.frame_at.tick, error);
	case CAU_LOOK_RESTORING:
		return cau_past_restore(past, error);
	default:
		return cau_past_slice(past, SLICE_S, over, error);
	}
}

static int32_t code_of(const cau_hosted *h)
{
	return h->ended ? CAU_RPC_NOT_HERE : h->drain_wanted ? CAU_RPC_DRAINING : 0;
}

// One stage of the present look, or one turn of its replay.
static void advance(cau_looks *looks)
{
	cau_error error = {0};
	bool over = true;
	cau_status status = check(looks, &error);
	if (!status) {
		tell_progress(looks);
		status = do_stage(looks, &over, &error);
	}
	looks->stage += over;
	bool done = looks->stage == CAU_LOOK_STAGE_COUNT;
	if (!status && done)
		status = answer(looks, &error);
	if (status || done)
		drop_present(looks, status ? &error : NULL, code_of(looks->hosted));
}

static void let_go(cau_looks *looks)
{
	cau_hosted *h = looks->hosted;
	cau_worker_pool_wake(h->around->pool, &h->task); // it is to know when the core is to go
	cau_hosted_release(h);
}

// On the builder, which has the core for as long as `busy`.
static void run(cau_job *job)
{
	cau_looks *looks = (cau_looks *)job;
	if (looks->tired)
		cau_past_finish(&looks->past);
	looks->tired = false;
	if (looks->present) {
		advance(looks);
	} else if (take_next(looks)) {
		looks->stage = CAU_LOOK_BUILDING;
	} else {
		let_go(looks);
		return;
	}
	go_on(looks);
}

// The builder ends.
static void drop(cau_job *job)
{
	cau_looks *looks = (cau_looks *)job;
	cau_error error = {0};
	cau_fail(&error, CAU_BAD_STATE, "", "the daemon is ending");
	do {
		if (looks->present)
			drop_present(looks, &error, CAU_RPC_DRAINING);
	} while (take_next(looks));
	cau_hosted_release(looks->hosted);
}

// ---- on the worker ------------------------------------------------------------------------------
static cau_looks *looks_of(cau_hosted *h)
{
	cau_looks *looks = h->looks ? NULL : calloc(1, sizeof *looks);
	if (looks) {
		looks->job = (cau_job){.run = run, .drop = drop};
		looks->hosted = looks->past.hosted = h;
		pthread_mutex_lock(&h->mutex);
		h->looks = looks;
		pthread_mutex_unlock(&h->mutex);
	}
	return h->looks;
}

// The builder has it from here on, unless it had it already.
static void wake(cau_looks *looks, bool was_busy)
{
	if (was_busy)
		return;
	cau_hosted_share(looks->hosted);
	looks->job.expected_s = READ_EXPECTED_S;
	cau_builder_submit(looks->hosted->around->builder, &looks->job);
}

static void line_up(cau_looks *looks, cau_order *order)
{
	cau_hosted *h = looks->hosted;
	pthread_mutex_lock(&h->mutex);
	cau_order **end = &looks->waiting;
	while (*end)
		end = &(*end)->next;
	order->next = NULL;
	*end = order;
	bool was_busy = looks->busy;
	looks->busy = true;
	pthread_mutex_unlock(&h->mutex);
	wake(looks, was_busy);
}

void cau_apply_frame_at(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	cau_looks *looks = looks_of(h);
	if (!looks)
		cau_fail(&error, CAU_NO_MEMORY, "", "no memory for a past view");
	else if (order->as.frame_at.tick > h->tick)
		cau_fail(&error, CAU_BAD_VALUE, "params.tick",
		         "the tick is later than the session's present tick");
	if (error.status) {
		cau_answer_fail(order, &error, 0);
		return;
	}
	order->as.frame_at.branch = h->branch;
	order->as.frame_at.epoch = h->epoch == UINT64_MAX ? 1 : ~h->epoch; // that of no stream
	cau_record_commit(h); // what the builder reads from the store is on its way there
	cau_looks_give_up(h, order->asker.client);
	line_up(looks, order);
}

void cau_apply_frame_cancel(cau_hosted *h, cau_order *order)
{
	cau_looks_give_up(h, order->asker.client);
	cau_answer_order(h, order, &(cau_wire_nothing){0});
}

void cau_looks_tire(cau_hosted *h, double now_s)
{
	pthread_mutex_lock(&h->mutex);
	bool tired = now_s >= cau_looks_tires_s(h->looks);
	if (tired)
		h->looks->busy = h->looks->tired = true;
	pthread_mutex_unlock(&h->mutex);
	if (tired)
		wake(h->looks, false);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Starts a session: from its scene, from the store, or from a state of another session.
#include <stdlib.h>

#include "cautery/scene_json.h"
#include "hosted_session/internal.h"
#include "hosted_session/life.h"
#include "hosted_session/mesh_reading.h"
#include "hosted_session/slice.h"

// Pieces of memory on each shelf: one is used by the store or the builder, and one is ready for the
// next slice.
enum { PIECES = 2 };

// Allocates memory in advance, if the limits allow it. Otherwise the memory is allocated when it is
// needed.
static void stock_shelves(cau_hosted *h)
{
	cau_error refused = {0};
	cau_stream_shape shape = cau_frames_shape(&h->core.info);
	size_t snapshot = cau_session_snapshot_bytes(h->core.session),
		   copy = cau_export_copy_bytes(&h->core.info);
	size_t opening = cau_streams_opening_bytes(shape.vertex_count, shape.face_count);
	if (cau_building_hold_session(
			h->identity.around, &h->creation.memory_held,
			h->creation.memory_held + (int64_t)(PIECES * (snapshot + copy) + opening), &refused))
		return;
	cau_shelf_stock(h->record.shelf, snapshot, PIECES);
	cau_shelf_stock(h->reads.copies, copy, PIECES);
	if (cau_streams_stock(&h->frames.streams, &shape, &refused))
		cau_log(CAU_LOG_WARNING, h->identity.id, "stream_not_stocked", "reason=\"%s\"",
		        refused.reason);
}

static cau_status create(cau_hosted *h, bool unsettled, cau_error *error)
{
	cau_session_def def = cau_default_session_def();
	def.scene = h->identity.scene;
	def.thread_count = (int32_t)h->identity.around->config->session_threads;
	def.border = cau_building_border;
	def.user = h;
	def.unsettled = unsettled;
	return cau_session_create(&def, &h->core.session, error);
}

static cau_status create_first(cau_hosted *h, cau_error *error)
{
	cau_status status = create(h, false, error);
	if (!status)
		cau_beginnings_keep(h->identity.around->beginnings, h->identity.scene, h->core.session);
	return status;
}

static bool begin_as(cau_session *core, const cau_beginning *known)
{
	bool exact = false;
	return known->tissue_hash == cau_session_tissue_hash(core) &&
	       !cau_session_restore(core, known->snapshot, known->byte_count, &exact, NULL) && exact;
}

// Builds the core with the rest state of the first session of this scene. If that state does not
// fit, the core settles by itself.
static cau_status create_as_before(cau_hosted *h, const cau_beginning *known, cau_error *error)
{
	cau_status status = create(h, true, error);
	if (status)
		return status;
	if (begin_as(h->core.session, known)) {
		cau_log(CAU_LOG_INFO, h->identity.id, "settled_before", "bytes=%zu", known->byte_count);
		return CAU_OK;
	}
	cau_beginnings_forget(h->identity.around->beginnings, known);
	cau_session_destroy(h->core.session);
	h->core.session = NULL;
	return create_first(h, error);
}

static cau_status create_new(cau_hosted *h, cau_error *error)
{
	cau_beginning *known = cau_beginnings_hold(h->identity.around->beginnings, h->identity.scene);
	if (!known)
		return create_first(h, error);
	cau_status status = create_as_before(h, known, error);
	cau_beginnings_let_go(h->identity.around->beginnings, known);
	return status;
}

static cau_status build(cau_hosted *h, cau_error *error)
{
	bool checkpoint_follows = h->creation.origin.kind != CAU_ORIGIN_SCENE;
	cau_status status = checkpoint_follows ? create(h, true, error) : create_new(h, error);
	if (status)
		return status;
	cau_session_set_clock(h->core.session, cau_monotonic_s);
	cau_session_describe(h->core.session, &h->core.info);
	stock_shelves(h);
	return CAU_OK;
}

// Writes the first rows of a session to the batch: definition and meshes. The first checkpoint
// follows later.
static cau_status record_session(cau_hosted *h, cau_error *error)
{
	size_t bytes = 0;
	char *json = malloc(CAU_SCENE_JSON_MAX_BYTES);
	cau_store_batch *batch = cau_record_batch(&h->record);
	if (!json || !batch) {
		free(json);
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the definition");
	}
	cau_status status =
		cau_scene_to_json(h->identity.scene, json, CAU_SCENE_JSON_MAX_BYTES, &bytes, error);
	cau_store_session row = {.id = h->identity.id,
	                         .name = h->identity.scene->name,
	                         .state = h->creation.pause_at_start ? "paused" : "running",
	                         .definition = {json, bytes},
	                         .mesh = {h->identity.meshes, h->identity.mesh_bytes}};
	if (!status)
		status = cau_store_put_session(batch, &row, error);
	free(json);
	return status;
}

static void answer_creator(cau_hosted *h)
{
	cau_order asked = {.asker = h->identity.creator,
	                   .client_sequence = h->identity.creator_sequence};
	cau_error error = {0};
	size_t bytes = 0;
	if (!cau_hosted_take_creator(&h->creation, &asked.reply) || !asked.reply.answer)
		return;
	char *text = cau_answer_description(h, asked.reply.method, &bytes, &error);
	if (!text) {
		cau_reply_fail(&asked.reply, &error, 0);
		return;
	}
	cau_record_answer(&h->record, &asked, text, bytes);
	cau_record_reply(&h->record, &asked.reply, text, bytes);
}

static cau_status replay(cau_hosted *h, const char *session, int64_t branch, uint64_t tick,
                         cau_error *error)
{
	cau_status status =
		cau_replay_read(&h->replay, h->identity.around->store, session, branch, tick, error);
	if (!status)
		status = cau_replay_restore(&h->replay, h->core.session, error);
	if (!status)
		h->core.tick = h->replay.tick;
	h->creation.replaying = !status;
	return status;
}

static cau_status resume_from_store(cau_hosted *h, cau_error *error)
{
	h->history.branch = h->creation.origin.branch;
	cau_status status = cau_history_load(&h->history, &h->identity, error);
	return status ? status : replay(h, h->identity.id, h->history.branch, UINT64_MAX, error);
}

void cau_hosted_tell_not_resumed(const char *id, cau_status status, const cau_error *error)
{
	cau_log(
		CAU_LOG_ERROR, id, "not_resumed",
		"status=%s path=%s reason=\"%s\" remedy=\"the session stays in the store; `cautery rm %s` "
		"removes it\"",
		cau_status_name(status), error->path, error->reason, id);
}

void cau_hosted_fail_start(cau_hosted *h, const cau_error *error)
{
	if (h->creation.unwanted)
		cau_log(CAU_LOG_NOTICE, h->identity.id, "build_ended", "reason=\"%s\"", error->reason);
	else if (h->creation.origin.kind == CAU_ORIGIN_STORE)
		cau_hosted_tell_not_resumed(h->identity.id, error->status, error);
	else
		cau_log(CAU_LOG_ERROR, h->identity.id, "start_failed", "status=%s path=%s reason=\"%s\"",
		        cau_status_name(error->status), error->path, error->reason);
	cau_store_batch_destroy(h->record.batch);
	h->record.batch = NULL;
	h->creation.starting = false;
	cau_hosted_end(h);
	cau_hosted_fail_creator(&h->creation, error, 0);
}

// Reads the rows of a session that arrives by a move. This shows that they are readable before the
// move is decided.
static cau_status try_out(cau_hosted *h, cau_error *error)
{
	cau_status status = cau_replay_read(&h->replay, h->identity.around->store, h->identity.id,
	                                    h->creation.origin.branch, UINT64_MAX, error);
	return status ? status : cau_replay_restore(&h->replay, h->core.session, error);
}

void cau_hosted_resume(cau_hosted *h)
{
	cau_error error = {0};
	if (resume_from_store(h, &error))
		cau_hosted_fail_start(h, &error);
	else if (!h->creation.replaying)
		cau_hosted_started(h);
}

void cau_hosted_start(cau_hosted *h)
{
	cau_error error = {0};
	double began_s = cau_monotonic_s();
	cau_status status = build(h, &error);
	if (!status && h->creation.incoming)
		status = try_out(h, &error);
	else if (!status && h->creation.origin.kind == CAU_ORIGIN_STORE)
		status = resume_from_store(h, &error);
	else if (!status && h->creation.origin.kind == CAU_ORIGIN_FORK)
		status = replay(h, h->creation.origin.session, h->creation.origin.branch,
		                h->creation.origin.tick, &error);
	if (!status && h->creation.origin.kind != CAU_ORIGIN_STORE)
		status = record_session(h, &error);
	if (status) {
		cau_hosted_fail_start(h, &error);
		return;
	}
	size_t shared = cau_session_share(h->core.session);
	cau_log(CAU_LOG_INFO, h->identity.id, "built", "seconds=%.3f vertices=%d shared_bytes=%zu",
	        cau_monotonic_s() - began_s, h->core.info.vertex_count, shared);
	if (h->creation.origin.kind == CAU_ORIGIN_SCENE)
		cau_mesh_log(h->identity.id, h->identity.scene, h->core.info.mesh_report);
	if (!h->creation.replaying && !h->creation.incoming)
		cau_hosted_started(h);
}

// Removes events after the last tick that the store can restore, because they have no effect any
// more.
static void go_on_from_events(cau_hosted_timeline *timeline)
{
	cau_error error = {0};
	cau_hosted_record *record = timeline->record;
	cau_store_batch *batch = cau_record_batch(record);
	if (!batch || cau_store_forget_events(batch, record->identity->id, record->history->branch,
	                                      record->core->tick, &error))
		cau_log(CAU_LOG_ERROR, record->identity->id, "events_not_forgotten", "reason=\"%s\"",
		        error.reason);
	cau_timeline_load(timeline);
}

// Continues the log after the last entry of this tick. The entries' numbers may have gaps where the
// store was full, so the number of entries is not the next number.
static void go_on_logging(cau_hosted_record *record, const cau_replay *replay)
{
	record->logged_order = 0;
	record->logged_acts = false;
	for (size_t i = 0; i < replay->count; i++) {
		const cau_replayed *entry = &replay->commands[i];
		if (entry->tick != record->core->tick)
			continue;
		record->logged_tick = record->core->tick;
		record->logged_order = entry->order + 1;
		record->logged_acts |= entry->acts;
	}
}

void cau_hosted_started(cau_hosted *h)
{
	bool restarted = h->creation.origin.kind == CAU_ORIGIN_STORE;
	int state = h->creation.pause_at_start ? CAU_SESSION_PAUSED : CAU_SESSION_RUNNING;
	if (cau_decisions_state(&h->decisions) == CAU_SESSION_FAULTED)
		state = CAU_SESSION_FAULTED;
	if (!restarted)
		h->history.first_tick = h->core.tick;
	h->record.logged_tick = UINT64_MAX;
	if (restarted)
		go_on_logging(&h->record, &h->replay);
	if (restarted)
		go_on_from_events(&h->timeline);
	cau_record_checkpoint(&h->record, NULL, NULL);
	if (!restarted)
		cau_record_mark(&h->record);
	cau_decide_arrived(h, state,
	                   h->creation.came ? "the session has moved"
	                   : restarted      ? "the daemon was restarted"
	                                    : "a new session");
	cau_frames_restart(&h->frames);
	cau_pace_restart(&h->pace, h->core.tick);
	cau_suspension_name_stage(&h->suspension, "");
	h->creation.starting = false;
	if (restarted)
		cau_log(CAU_LOG_NOTICE, h->identity.id, "resumed", "tick=%llu exact=%d",
		        (unsigned long long)h->core.tick, h->replay.exact);
	else
		cau_timeline_add(&h->timeline, CAU_EVENT_CREATED, NULL, h->identity.creator.name, 0, NULL);
	// clients that had joined here know the session already
	bool known = restarted && !h->creation.came;
	cau_answer_changed(h, known ? CAU_CHANGE_RESTARTED : CAU_CHANGE_CREATED,
	                   h->identity.creator.name);
	answer_creator(h);
}

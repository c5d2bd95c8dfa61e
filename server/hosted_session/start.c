// SPDX-License-Identifier: GPL-3.0-or-later
// How a session comes to be: from its scene, from the store, or from another session's state.
#include <stdlib.h>
#include <string.h>

#include "cautery/scene_json.h"
#include "hosted_session/internal.h"

// On each shelf one piece is in use, by the store or the builder, and one is there for the next
// slice.
enum { PIECES = 2 };

// What the settings do not allow it to hold is made when it is needed.
static void stock_shelves(cau_hosted *h)
{
	cau_error refused = {0};
	cau_stream_shape shape = cau_frames_shape(&h->info);
	size_t snapshot = cau_session_snapshot_bytes(h->core), copy = cau_export_copy_bytes(&h->info);
	size_t opening = cau_streams_opening_bytes(shape.vertex_count, shape.face_count);
	if (cau_building_hold(h, PIECES * (snapshot + copy) + opening, &refused))
		return;
	cau_shelf_stock(h->snapshot_shelf, snapshot, PIECES);
	cau_shelf_stock(h->copy_shelf, copy, PIECES);
	if (cau_streams_stock(&h->streams, &shape, &refused))
		cau_log(CAU_LOG_WARNING, h->id, "stream_not_stocked", "reason=\"%s\"", refused.reason);
}

static cau_status create(cau_hosted *h, bool unsettled, cau_error *error)
{
	cau_session_def def = cau_default_session_def();
	def.scene = h->scene;
	def.thread_count = (int32_t)h->around->config->session_threads;
	def.border = cau_building_border;
	def.user = h;
	def.unsettled = unsettled;
	return cau_session_create(&def, &h->core, error);
}

static cau_status create_first(cau_hosted *h, cau_error *error)
{
	cau_status status = create(h, false, error);
	if (!status)
		cau_beginnings_keep(h->around->beginnings, h->scene, h->core);
	return status;
}

static bool begin_as(cau_hosted *h, const cau_beginning *known)
{
	bool exact = false;
	return known->tissue_hash == cau_session_tissue_hash(h->core) &&
	       !cau_session_restore(h->core, known->snapshot, known->byte_count, &exact, NULL) && exact;
}

// As the first session of its scene began; settled by itself where that does not serve.
static cau_status create_as_before(cau_hosted *h, const cau_beginning *known, cau_error *error)
{
	cau_status status = create(h, true, error);
	if (status)
		return status;
	if (begin_as(h, known)) {
		cau_log(CAU_LOG_INFO, h->id, "settled_before", "bytes=%zu", known->byte_count);
		return CAU_OK;
	}
	cau_beginnings_forget(h->around->beginnings, known);
	cau_session_destroy(h->core);
	h->core = NULL;
	return create_first(h, error);
}

static cau_status create_new(cau_hosted *h, cau_error *error)
{
	cau_beginning *known = cau_beginnings_hold(h->around->beginnings, h->scene);
	if (!known)
		return create_first(h, error);
	cau_status status = create_as_before(h, known, error);
	cau_beginnings_let_go(h->around->beginnings, known);
	return status;
}

static cau_status build(cau_hosted *h, cau_error *error)
{
	bool checkpoint_follows = h->origin.kind != CAU_ORIGIN_SCENE;
	cau_status status = checkpoint_follows ? create(h, true, error) : create_new(h, error);
	if (status)
		return status;
	cau_session_set_clock(h->core, cau_monotonic_s);
	cau_session_describe(h->core, &h->info);
	stock_shelves(h);
	return CAU_OK;
}

// The first rows of a session: definition, meshes, and later the first checkpoint.
static cau_status record_session(cau_hosted *h, cau_error *error)
{
	size_t bytes = 0;
	char *json = malloc(CAU_SCENE_JSON_MAX_BYTES);
	cau_store_batch *batch = cau_record_batch(h);
	if (!json || !batch) {
		free(json);
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the definition");
	}
	cau_status status = cau_scene_to_json(h->scene, json, CAU_SCENE_JSON_MAX_BYTES, &bytes, error);
	cau_store_session row = {.id = h->id,
	                         .name = h->scene->name,
	                         .state = h->pause_at_start ? "paused" : "running",
	                         .definition = {json, bytes},
	                         .mesh = {h->meshes, h->mesh_bytes}};
	if (!status)
		status = cau_store_put_session(batch, &row, error);
	free(json);
	return status;
}

static void answer_creator(cau_hosted *h)
{
	cau_order asked = {.asker = h->creator, .client_sequence = h->creator_sequence};
	cau_error error = {0};
	size_t bytes = 0;
	if (!cau_hosted_take_creator(h, &asked.reply) || !asked.reply.answer)
		return;
	char *text = cau_answer_description(h, asked.reply.method, &bytes, &error);
	if (!text) {
		cau_reply_fail(&asked.reply, &error, 0);
		return;
	}
	cau_record_answer(h, &asked, text, bytes);
	cau_record_reply(h, &asked.reply, text, bytes);
}

static cau_status take_beginning(void *user, const cau_store_event *event)
{
	cau_hosted *h = user;
	h->first_tick = event->tick;
	return CAU_OK;
}

// "name=five branch=0", somewhere in the event's detail.
static bool read_snapshot(const char *text, cau_named_snapshot *made)
{
	static const char name[] = "name=", branch[] = " branch=";
	const char *at = strstr(text, name), *end = at ? strstr(at, branch) : NULL;
	if (!end)
		return false;
	at += strlen(name);
	size_t bytes = (size_t)(end - at);
	if (bytes >= sizeof made->name)
		return false;
	memcpy(made->name, at, bytes);
	made->name[bytes] = 0;
	made->branch = strtoll(end + strlen(branch), NULL, 10);
	return true;
}

static cau_status take_snapshot(void *user, const cau_store_event *event)
{
	cau_hosted *h = user;
	cau_named_snapshot *made = &h->snapshots[h->snapshot_count];
	if (h->snapshot_count < SNAPSHOT_COUNT && read_snapshot(event->text, made)) {
		made->tick = event->tick;
		h->snapshot_count++;
	}
	return CAU_OK;
}

static cau_status count_branch(void *user, const cau_store_branch *branch)
{
	cau_hosted *h = user;
	if (branch->branch >= h->next_branch)
		h->next_branch = branch->branch + 1;
	return CAU_OK;
}

static cau_status replay(cau_hosted *h, const char *session, int64_t branch, uint64_t tick,
                         cau_error *error)
{
	cau_status status = cau_replay_read(&h->replay, h->around->store, session, branch, tick, error);
	if (!status)
		status = cau_replay_restore(&h->replay, h->core, error);
	if (!status)
		h->tick = h->replay.tick;
	h->replaying = !status;
	return status;
}

static cau_status resume_from_store(cau_hosted *h, cau_error *error)
{
	cau_store *store = h->around->store;
	h->branch = h->origin.branch;
	cau_status status = cau_store_read_branches(store, h->id, count_branch, h, error);
	if (!status)
		status = cau_store_read_events(store, h->id, "created", 1, take_beginning, h, error);
	if (!status)
		status = cau_store_read_events(store, h->id, "snapshot", SNAPSHOT_COUNT, take_snapshot, h,
		                               error);
	return status ? status : replay(h, h->id, h->branch, UINT64_MAX, error);
}

void cau_hosted_tell_not_resumed(const char *id, cau_status status, const cau_error *error)
{
	cau_log(CAU_LOG_ERROR, id, "not_resumed",
	        "status=%s path=%s reason=\"%s\" remedy=\"it stays in the store; `cautery rm %s` "
	        "removes it\"",
	        cau_status_name(status), error->path, error->reason, id);
}

void cau_hosted_fail_start(cau_hosted *h, const cau_error *error)
{
	if (h->unwanted)
		cau_log(CAU_LOG_NOTICE, h->id, "build_ended", "reason=\"%s\"", error->reason);
	else if (h->origin.kind == CAU_ORIGIN_STORE)
		cau_hosted_tell_not_resumed(h->id, error->status, error);
	else
		cau_log(CAU_LOG_ERROR, h->id, "start_failed", "status=%s path=%s reason=\"%s\"",
		        cau_status_name(error->status), error->path, error->reason);
	cau_store_batch_destroy(h->batch);
	h->batch = NULL;
	h->starting = false;
	cau_hosted_end(h);
	cau_hosted_fail_creator(h, error, 0);
}

// Of a move: what has come is read once, so that it is known to be readable before anybody decides.
static cau_status try_out(cau_hosted *h, cau_error *error)
{
	cau_status status =
		cau_replay_read(&h->replay, h->around->store, h->id, h->origin.branch, UINT64_MAX, error);
	return status ? status : cau_replay_restore(&h->replay, h->core, error);
}

void cau_hosted_resume(cau_hosted *h)
{
	cau_error error = {0};
	if (resume_from_store(h, &error))
		cau_hosted_fail_start(h, &error);
	else if (!h->replaying)
		cau_hosted_started(h);
}

void cau_hosted_start(cau_hosted *h)
{
	cau_error error = {0};
	double began_s = cau_monotonic_s();
	cau_status status = build(h, &error);
	if (!status && h->incoming)
		status = try_out(h, &error);
	else if (!status && h->origin.kind == CAU_ORIGIN_STORE)
		status = resume_from_store(h, &error);
	else if (!status && h->origin.kind == CAU_ORIGIN_FORK)
		status = replay(h, h->origin.session, h->origin.branch, h->origin.tick, &error);
	if (!status && h->origin.kind != CAU_ORIGIN_STORE)
		status = record_session(h, &error);
	if (status) {
		cau_hosted_fail_start(h, &error);
		return;
	}
	size_t shared = cau_session_share(h->core);
	cau_log(CAU_LOG_INFO, h->id, "built", "seconds=%.3f vertices=%d shared_bytes=%zu",
	        cau_monotonic_s() - began_s, h->info.vertex_count, shared);
	if (h->origin.kind == CAU_ORIGIN_SCENE)
		cau_mesh_log(h->id, h->scene, h->info.mesh_report);
	if (!h->replaying && !h->incoming)
		cau_hosted_started(h);
}

// What was seen after the tick that the store leads to has not come about.
static void go_on_from_events(cau_hosted *h)
{
	cau_error error = {0};
	cau_store_batch *batch = cau_record_batch(h);
	if (!batch || cau_store_forget_events(batch, h->id, h->branch, h->tick, &error))
		cau_log(CAU_LOG_ERROR, h->id, "events_not_forgotten", "reason=\"%s\"", error.reason);
	cau_events_load(h);
}

// The next log entry follows the last one of this tick. The numbers of a tick have gaps where the
// store was full, so the count of its entries is not the next number.
static void go_on_logging(cau_hosted *h)
{
	h->logged_order = 0;
	h->logged_acts = false;
	for (size_t i = 0; i < h->replay.count; i++) {
		const cau_replayed *entry = &h->replay.commands[i];
		if (entry->tick != h->tick)
			continue;
		h->logged_tick = h->tick;
		h->logged_order = entry->order + 1;
		h->logged_acts |= entry->acts;
	}
}

void cau_hosted_started(cau_hosted *h)
{
	bool restarted = h->origin.kind == CAU_ORIGIN_STORE;
	int state = h->pause_at_start ? CAU_SESSION_PAUSED : CAU_SESSION_RUNNING;
	if (cau_decided_state(h) == CAU_SESSION_FAULTED)
		state = CAU_SESSION_FAULTED;
	if (!restarted)
		h->first_tick = h->tick;
	h->logged_tick = UINT64_MAX;
	if (restarted)
		go_on_logging(h);
	if (restarted)
		go_on_from_events(h);
	cau_record_checkpoint(h, NULL, NULL);
	if (!restarted)
		cau_record_mark(h);
	cau_decide_arrived(h, state,
	                   h->came     ? "the session has moved"
	                   : restarted ? "the daemon was restarted"
	                               : "a new session");
	cau_frames_restart(h);
	h->window_s = cau_monotonic_s();
	h->window_tick = h->tick;
	h->stage[0] = 0;
	h->starting = false;
	if (restarted)
		cau_log(CAU_LOG_NOTICE, h->id, "resumed", "tick=%llu exact=%d", (unsigned long long)h->tick,
		        h->replay.exact);
	else
		cau_event_add(h, CAU_EVENT_CREATED, NULL, h->creator.name, 0, NULL);
	bool known = restarted && !h->came; // to who joined it here
	cau_answer_changed(h, known ? CAU_CHANGE_RESTARTED : CAU_CHANGE_CREATED, h->creator.name);
	answer_creator(h);
}

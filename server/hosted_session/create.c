// SPDX-License-Identifier: GPL-3.0-or-later
// Creates a session and adds it to the worker pool. Also stops and drains sessions for the daemon.
#include <stdlib.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

// Notes the store's present state. Later the store reports only changes.
static void note_store(cau_hosted *h)
{
	cau_store_health health;
	cau_store_get_health(h->identity.around->store, &health);
	if (health.state != CAU_STORE_READY)
		cau_hosted_store_takes(h, false, health.reason);
}

// Allocates a session with memory for `orders` orders. Returns NULL if memory runs out.
static cau_hosted *allocate(int32_t orders)
{
	cau_hosted *h = calloc(1, sizeof *h);
	if (!h)
		return NULL;
	h->core.described = malloc(sizeof *h->core.described);
	h->decisions.logic = malloc(cau_logic_bytes(orders));
	h->record.shelf = cau_shelf_create();
	h->reads.copies = cau_shelf_create();
	if (h->core.described && h->decisions.logic && h->record.shelf && h->reads.copies)
		return h;
	cau_shelf_release(h->record.shelf);
	cau_shelf_release(h->reads.copies);
	free(h->core.described);
	free(h->decisions.logic);
	free(h);
	return NULL;
}

// Sets the members to their values before the session is built.
static void init(cau_hosted *h, const cau_surroundings *around, const cau_hosted_def *def)
{
	h->task.run = cau_hosted_run;
	h->references = 1;
	h->identity.around = around;
	snprintf(h->identity.id, sizeof h->identity.id, "%s", def->id);
	h->identity.number = def->number;
	h->identity.scene = def->scene;
	h->identity.meshes = def->meshes;
	h->identity.mesh_bytes = def->mesh_bytes;
	h->creation.origin = def->origin;
	h->identity.creator = def->creator;
	h->identity.creator_sequence = def->client_sequence;
	h->creation.reply = def->reply;
	h->creation.pause_at_start = def->paused;
	h->creation.incoming = def->incoming;
	h->history.next_branch = 1;
	h->creation.starting = h->creation.unanswered = h->suspension.active = h->creation.waits = true;
	pthread_mutex_init(&h->suspension.lock, NULL);
	pthread_mutex_init(&h->published.lock, NULL);
	pthread_mutex_init(&h->refusals.lock, NULL);
	pthread_mutex_init(&h->reads.lock, NULL);
	cau_past_views_init(&h->past, h);
	cau_record_init(&h->record, &h->identity, &h->core, &h->history, &h->commits);
	h->timeline.core = &h->core;
	h->timeline.record = &h->record;
	h->frames.streams = (cau_streams){.id = h->identity.id,
	                                  .session = h->identity.number,
	                                  .subscribers_most = around->config->max_subscribers,
	                                  .in_flight_most = (size_t)around->config->subscriber_bytes};
	cau_streams_init(&h->frames.streams);
	cau_decisions_init(&h->decisions, (int32_t)around->config->queue_commands,
	                   h->identity.scene->step_s);
	cau_decisions_open_trace(&h->decisions, &h->identity);
	cau_hosted_publish_summary(h);
}

cau_status cau_hosted_create(cau_hosted **made, const cau_surroundings *around,
                             const cau_hosted_def *def, cau_error *error)
{
	*made = NULL;
	cau_status status = CAU_OK;
	cau_hosted *h = allocate((int32_t)around->config->queue_commands);
	if (!h)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
	init(h, around, def);
	if (!cau_worker_pool_add(around->pool, &h->task)) {
		status = cau_fail(
			error, CAU_LIMIT, NULL,
			"the daemon has the largest number of sessions (setting max_sessions): destroy one");
		goto give_up;
	}
	note_store(h);
	status = cau_building_begin(h, error);
	if (!status) {
		*made = h;
		return CAU_OK;
	}
	cau_worker_pool_remove(around->pool, &h->task);
give_up:
	h->identity.scene = NULL; // the caller keeps these on failure
	h->identity.meshes = NULL;
	cau_hosted_release(h);
	return status;
}

void cau_hosted_stop(cau_hosted *h)
{
	cau_worker_pool_remove(h->identity.around->pool, &h->task);
	if (h->suspension.active) // the builder has the session, and refuses its waiting orders later
		return;
	cau_hosted_end(h);
	cau_hosted_refuse_rest(h);
}

void cau_hosted_want_checkpoint(cau_hosted *h)
{
	h->commits.checkpoint_wanted = true;
	cau_worker_pool_wake(h->identity.around->pool, &h->task);
}

void cau_hosted_drain(cau_hosted *h)
{
	h->life.drain_wanted = true;
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_DRAIN, .time_s = cau_monotonic_s()});
	cau_worker_pool_wake(h->identity.around->pool, &h->task);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// How a session comes among the others, and what the daemon wants of it at the end.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

// The store tells of changes only.
static void note_store(cau_hosted *h)
{
	cau_store_health health;
	cau_store_get_health(h->around->store, &health);
	if (health.state != CAU_STORE_READY)
		cau_hosted_store_takes(h, false, health.reason);
}

// NULL: there is no memory for it.
static cau_hosted *allocate(int32_t orders)
{
	cau_hosted *h = calloc(1, sizeof *h);
	if (!h)
		return NULL;
	h->present = malloc(sizeof *h->present);
	h->logic = malloc(cau_logic_bytes(orders));
	h->snapshot_shelf = cau_shelf_create();
	h->copy_shelf = cau_shelf_create();
	if (h->present && h->logic && h->snapshot_shelf && h->copy_shelf)
		return h;
	cau_shelf_release(h->snapshot_shelf);
	cau_shelf_release(h->copy_shelf);
	free(h->present);
	free(h->logic);
	free(h);
	return NULL;
}

// As it is until the builder has built it.
static void init(cau_hosted *h, const cau_surroundings *around, const cau_hosted_def *def)
{
	h->task.run = cau_hosted_run;
	h->references = 1;
	h->around = around;
	snprintf(h->id, sizeof h->id, "%s", def->id);
	h->number = def->number;
	h->scene = def->scene;
	h->meshes = def->meshes;
	h->mesh_bytes = def->mesh_bytes;
	h->origin = def->origin;
	h->creator = def->creator;
	h->creator_sequence = def->client_sequence;
	h->creator_reply = def->reply;
	h->pause_at_start = def->paused;
	h->incoming = def->incoming;
	h->next_branch = 1;
	h->lost_from = h->batch_lost = UINT64_MAX;
	h->starting = h->unanswered = h->away = h->creator_waits = true;
	pthread_mutex_init(&h->mutex, NULL);
	pthread_mutex_init(&h->deciding, NULL);
	h->streams = (cau_streams){.id = h->id,
	                           .session = h->number,
	                           .subscribers_most = around->config->max_subscribers,
	                           .in_flight_most = (size_t)around->config->subscriber_bytes};
	cau_streams_init(&h->streams);
	cau_logic_init(h->logic, (int32_t)around->config->queue_commands);
	h->logic->step_s = h->scene->step_s;
	cau_decide_trace(h);
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
			"the daemon has as many sessions as it may (setting max_sessions): destroy one");
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
	h->scene = NULL; // stays the caller's
	h->meshes = NULL;
	cau_hosted_release(h);
	return status;
}

void cau_hosted_stop(cau_hosted *h)
{
	cau_worker_pool_remove(h->around->pool, &h->task);
	if (h->away) // the builder has it, and refuses what waits as it gives it back
		return;
	cau_hosted_end(h);
	cau_hosted_refuse_rest(h);
}

void cau_hosted_want_checkpoint(cau_hosted *h)
{
	h->checkpoint_wanted = true;
	cau_worker_pool_wake(h->around->pool, &h->task);
}

void cau_hosted_drain(cau_hosted *h)
{
	h->drain_wanted = true;
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_DRAIN, .time_s = cau_monotonic_s()});
	cau_worker_pool_wake(h->around->pool, &h->task);
}

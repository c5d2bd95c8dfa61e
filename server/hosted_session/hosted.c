// SPDX-License-Identifier: GPL-3.0-or-later
// The life of a hosted session and its queue.
#include "hosted_session/hosted.h"

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

cau_status cau_hosted_create(cau_hosted **made, const cau_surroundings *around,
                             const cau_hosted_def *def, cau_error *error)
{
	cau_hosted *h = calloc(1, sizeof *h);
	*made = NULL;
	int32_t orders = (int32_t)around->config->queue_commands;
	if (h) {
		h->present = malloc(sizeof *h->present);
		h->logic = malloc(cau_logic_bytes(orders));
	}
	if (!h || !h->present || !h->logic) {
		free(h ? h->present : NULL);
		free(h ? h->logic : NULL);
		free(h);
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
	}
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
	h->next_branch = 1;
	h->lost_from = h->batch_lost = UINT64_MAX;
	h->starting = h->unanswered = h->away = true;
	pthread_mutex_init(&h->mutex, NULL);
	pthread_mutex_init(&h->deciding, NULL);
	cau_logic_init(h->logic, orders);
	h->logic->step_s = h->scene->step_s;
	cau_hosted_publish_summary(h);
	if (!cau_worker_pool_add(around->pool, &h->task)) {
		h->scene = NULL; // stays the caller's
		h->meshes = NULL;
		cau_hosted_release(h);
		return cau_fail(error, CAU_LIMIT, NULL, "the daemon has as many sessions as it may");
	}
	note_store(h);
	if (cau_building_begin(h, error)) {
		h->scene = NULL; // stays the caller's
		h->meshes = NULL;
		cau_worker_pool_remove(around->pool, &h->task);
		cau_hosted_release(h);
		return CAU_NO_MEMORY;
	}
	*made = h;
	return CAU_OK;
}

cau_hosted *cau_hosted_share(cau_hosted *h)
{
	atomic_fetch_add(&h->references, 1);
	return h;
}

void cau_hosted_refuse_gone(cau_order *order)
{
	cau_error error = {.status = CAU_NOT_FOUND, .reason = "the session is gone"};
	cau_answer_fail(order, &error, CAU_RPC_NOT_HERE);
}

static void refuse_ticket(uint64_t ticket)
{
	cau_hosted_refuse_gone((cau_order *)(uintptr_t)ticket);
}

void cau_hosted_release(cau_hosted *h)
{
	if (!h || atomic_fetch_sub(&h->references, 1) != 1)
		return;
	for (int32_t i = 0; i < h->logic->count; i++)
		refuse_ticket(h->logic->waiting[i].asked.ticket);
	if (h->logic->stepping)
		refuse_ticket(h->logic->stepping);
	for (cau_order *next; h->reads; h->reads = next) {
		next = h->reads->next;
		cau_hosted_refuse_gone(h->reads);
	}
	if (h->replay.order)
		cau_hosted_refuse_gone(h->replay.order);
	cau_replay_finish(&h->replay);
	cau_streams_destroy(h);
	cau_store_batch_destroy(h->batch);
	cau_session_destroy(h->core);
	if (h->memory_held)
		atomic_fetch_sub(h->around->memory_held, h->memory_held);
	pthread_mutex_destroy(&h->mutex);
	pthread_mutex_destroy(&h->deciding);
	free(h->logic);
	free(h->scene);
	free(h->present);
	free(h->meshes);
	free(h);
}

void cau_hosted_stop(cau_hosted *h)
{
	cau_worker_pool_remove(h->around->pool, &h->task);
}

const char *cau_hosted_id(const cau_hosted *h)
{
	return h->id;
}

uint32_t cau_hosted_number(const cau_hosted *h)
{
	return h->number;
}

const cau_scene_def *cau_hosted_scene(const cau_hosted *h)
{
	return h->scene;
}

int64_t cau_hosted_branch(const cau_hosted *h)
{
	return h->branch;
}

bool cau_hosted_ended(cau_hosted *h)
{
	return h->ended;
}

bool cau_hosted_starting(cau_hosted *h)
{
	return h->unanswered && !h->ended;
}

bool cau_hosted_made_by(const cau_hosted *h, const char *client_id, int64_t client_sequence)
{
	return client_sequence && h->creator_sequence == client_sequence &&
	       strcmp(h->creator.client_id, client_id) == 0;
}

void cau_hosted_summary(cau_hosted *h, cau_wire_session_summary *summary)
{
	pthread_mutex_lock(&h->mutex);
	*summary = h->summary;
	summary->subscriber_count = 0; // changes without a slice
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		summary->subscriber_count += h->streams[i].subscribers;
	pthread_mutex_unlock(&h->mutex);
}

void cau_hosted_count(cau_hosted *h, cau_hosted_counts *counts)
{
	pthread_mutex_lock(&h->mutex);
	*counts = h->counts;
	for (int i = 0; i < CAU_STREAM_PROFILES_MAX; i++)
		counts->half_rate += h->streams[i].half.subscribers;
	pthread_mutex_unlock(&h->mutex);
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

bool cau_hosted_drained(cau_hosted *h)
{
	return h->drained || h->ended;
}

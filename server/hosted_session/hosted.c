// SPDX-License-Identifier: GPL-3.0-or-later
// The life of a hosted session and its queue.
#include "hosted_session/hosted.h"

#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

cau_status cau_hosted_create(cau_hosted **made, const cau_surroundings *around,
                             const cau_hosted_def *def, cau_error *error)
{
	cau_hosted *h = calloc(1, sizeof *h);
	*made = NULL;
	if (h)
		h->present = malloc(sizeof *h->present);
	if (!h || !h->present) {
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
	h->speed = 1;
	h->next_branch = 1;
	h->state = CAU_SESSION_STARTING;
	h->lost_from = h->batch_lost = UINT64_MAX;
	h->starting = h->unanswered = true;
	pthread_mutex_init(&h->mutex, NULL);
	cau_hosted_publish_summary(h);
	if (!cau_worker_pool_add(around->pool, &h->task)) {
		h->scene = NULL; // stays the caller's
		h->meshes = NULL;
		cau_hosted_release(h);
		return cau_fail(error, CAU_LIMIT, NULL, "the daemon has as many sessions as it may");
	}
	*made = h;
	return CAU_OK;
}

cau_hosted *cau_hosted_share(cau_hosted *h)
{
	atomic_fetch_add(&h->references, 1);
	return h;
}

static void free_orders(cau_order *orders)
{
	cau_error error = {.status = CAU_NOT_FOUND, .reason = "the session is gone"};
	for (cau_order *next; orders; orders = next) {
		next = orders->next;
		cau_answer_fail(orders, &error, CAU_RPC_NOT_HERE);
	}
}

void cau_hosted_release(cau_hosted *h)
{
	if (!h || atomic_fetch_sub(&h->references, 1) != 1)
		return;
	free_orders(h->first);
	free_orders(h->reads);
	free_orders(h->postponed);
	if (h->stepping)
		free_orders(h->stepping);
	if (h->replay.order)
		free_orders(h->replay.order);
	cau_replay_finish(&h->replay);
	cau_streams_destroy(h);
	cau_store_batch_destroy(h->batch);
	cau_session_destroy(h->core);
	pthread_mutex_destroy(&h->mutex);
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

// ---- the queue

// The newest waiting order about the same tool, if that is motion of the same driver: then nothing
// stands between the two, and the newer pose counts.
static cau_order *superseded(cau_hosted *h, const cau_order *order)
{
	cau_order *found = NULL;
	for (cau_order *o = h->first; o; o = o->next) {
		bool same =
			o->kind == CAU_ORDER_COMMAND && strcmp(o->as.command.tool, order->as.command.tool) == 0;
		if (same || o->kind != CAU_ORDER_COMMAND)
			found = same && o->motion && o->asker.client == order->asker.client ? o : NULL;
	}
	return found;
}

static bool store_takes(cau_hosted *h, cau_error *error)
{
	cau_store_health health;
	cau_store_get_health(h->around->store, &health);
	if (health.state == CAU_STORE_READY)
		return true;
	cau_fail(error, CAU_IO, "", "the store is %s: %s", cau_store_state_name(health.state),
	         health.reason);
	return false;
}

static void append(cau_hosted *h, cau_order *order)
{
	order->next = NULL;
	if (h->last)
		h->last->next = order;
	else
		h->first = order;
	h->last = order;
	h->queued++;
}

static bool changes(const cau_order *order)
{
	const cau_method_info *method = cau_method_describe(order->reply.method);
	return order->motion || !method || method->changes;
}

cau_status cau_hosted_submit(cau_hosted *h, cau_order *order, cau_error *error)
{
	if (h->ended)
		return cau_fail(error, CAU_NOT_FOUND, "params.session", "the session is destroyed");
	if (cau_reads_are(order))
		return cau_reads_submit(h, order, error);
	if (h->drain_wanted && changes(order))
		return cau_fail(error, CAU_BAD_STATE, "", "the daemon is ending");
	if (changes(order) && !store_takes(h, error)) {
		if (order->motion)
			cau_drive_refuse(h, order, error);
		return CAU_IO;
	}
	pthread_mutex_lock(&h->mutex);
	cau_order *older = order->motion ? superseded(h, order) : NULL;
	bool full = !older && h->queued >= h->around->config->queue_commands;
	if (older)
		older->as.command = order->as.command;
	else if (!full)
		append(h, order);
	// Motion of a running session waits for the tick border that comes anyway.
	bool wake = !order->motion || h->summary.state != CAU_SESSION_RUNNING;
	pthread_mutex_unlock(&h->mutex);
	if (full) {
		cau_fail(error, CAU_LIMIT, "", "the session's queue is full (setting queue_commands)");
		if (order->motion)
			cau_drive_refuse(h, order, error);
		return CAU_LIMIT;
	}
	if (older)
		free(order);
	if (wake)
		cau_worker_pool_wake(h->around->pool, &h->task);
	return CAU_OK;
}

void cau_hosted_want_checkpoint(cau_hosted *h)
{
	h->checkpoint_wanted = true;
	cau_worker_pool_wake(h->around->pool, &h->task);
}

void cau_hosted_drain(cau_hosted *h)
{
	h->drain_wanted = true;
	cau_worker_pool_wake(h->around->pool, &h->task);
}

bool cau_hosted_drained(cau_hosted *h)
{
	return h->drained || h->ended;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What only reads a session waits apart from its drivers: it has a queue of its own with a bound of
// its own, is served after their commands, for a moment in each slice, and leaves what takes long
// to the builder. So nobody who may merely look can slow a session down or fill its queue.
#include <stdlib.h>

#include "hosted_session/internal.h"

#define BORDER_SOON_S 0.0334 // a running session's reads wait for a border that is this near

enum {
	FILES_AT_ONCE = 2, // of one session with the builder: each holds a copy of its state
	CLIENT_SHARE = 4,  // one client has at most this part of the queue
};

bool cau_reads_are(const cau_order *order)
{
#define CHANGE(...)
#define READ(kind, apply) [CAU_ORDER_##kind] = true,
	static const bool reads[CAU_ORDER_COUNT] = {CAU_ORDER_TABLE(CHANGE, READ)};
#undef CHANGE
#undef READ
	return reads[order->kind];
}

bool cau_reads_make_file(const cau_order *order)
{
	return cau_method_describe(order->reply.method)->cost == CAU_COST_FILE;
}

static cau_status append(cau_hosted *h, cau_order *order, cau_error *error)
{
	int64_t most = h->around->config->queue_reads, its_own = 0;
	if (h->ended)
		return cau_fail(error, CAU_NOT_FOUND, "params.session", "the session is destroyed");
	if (h->drain_wanted) // its last slice serves what waits by now
		return cau_fail(error, CAU_BAD_STATE, "", "the daemon is ending");
	cau_order **end = &h->reads;
	for (; *end; end = &(*end)->next)
		its_own += (*end)->asker.client == order->asker.client;
	if (h->read_count >= most)
		return cau_fail(error, CAU_LIMIT, "",
		                "%lld requests that read this session wait (setting queue_reads): try "
		                "again in 1 s",
		                (long long)most);
	if (its_own >= most / CLIENT_SHARE)
		return cau_fail(error, CAU_LIMIT, "",
		                "%lld requests of this client that read the session wait, a quarter of "
		                "what may (setting queue_reads): try again when one is answered",
		                (long long)its_own);
	order->next = NULL;
	*end = order;
	h->read_count++;
	return CAU_OK;
}

cau_status cau_reads_submit(cau_hosted *h, cau_order *order, cau_error *error)
{
	if (!order->reply.answer) { // nobody would hear the answer
		free(order);
		return CAU_OK;
	}
	pthread_mutex_lock(&h->mutex);
	cau_status status = append(h, order, error);
	bool soon = h->summary.state == CAU_SESSION_RUNNING &&
	            h->summary.step_s <= BORDER_SOON_S * h->summary.speed;
	pthread_mutex_unlock(&h->mutex);
	if (!status && !soon)
		cau_worker_pool_wake(h->around->pool, &h->task);
	return status;
}

int32_t cau_reads_note(cau_hosted *h)
{
	pthread_mutex_lock(&h->mutex);
	int32_t count = h->read_count;
	pthread_mutex_unlock(&h->mutex);
	return count;
}

cau_order *cau_reads_take(cau_hosted *h, int32_t *noted)
{
	pthread_mutex_lock(&h->mutex);
	cau_order **place = &h->reads;
	int32_t passed = 0;
	while (*place && passed < *noted && cau_reads_make_file(*place) && h->files >= FILES_AT_ONCE) {
		place = &(*place)->next;
		passed++;
	}
	cau_order *order = passed < *noted ? *place : NULL;
	if (order) {
		*place = order->next;
		order->next = NULL;
		h->read_count--;
		--*noted;
	}
	pthread_mutex_unlock(&h->mutex);
	return order;
}

void cau_reads_refuse(cau_hosted *h)
{
	pthread_mutex_lock(&h->mutex);
	cau_order *order = h->reads;
	h->reads = NULL;
	h->read_count = 0;
	pthread_mutex_unlock(&h->mutex);
	for (cau_order *next; order; order = next) {
		next = order->next;
		cau_hosted_refuse_gone(h, order);
	}
}

bool cau_reads_wait(cau_hosted *h)
{
	pthread_mutex_lock(&h->mutex);
	const cau_order *order = h->reads;
	while (order && cau_reads_make_file(order) && h->files >= FILES_AT_ONCE)
		order = order->next;
	pthread_mutex_unlock(&h->mutex);
	return order != NULL;
}

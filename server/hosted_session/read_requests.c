// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/read_requests.h"

#include <stdlib.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

// Longest time between two tick borders, s of wall time, with which a read waits for the next
// border. With a longer time the read wakes the worker at once.
#define BORDER_SOON_S 0.0334

enum {
	FILES_AT_ONCE = 2, // most files of one session with the builder: each has a copy of its state
	CLIENT_SHARE = 4,  // divisor of the queue's capacity: one client may use at most 1/4 of it
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
	int64_t most = h->identity.around->config->queue_reads, its_own = 0;
	if (h->life.ended)
		return cau_fail(error, CAU_NOT_FOUND, "params.session", "the session is destroyed");
	if (h->life.drain_wanted) // the last slice serves only the requests that wait by now
		return cau_fail(error, CAU_BAD_STATE, "", "the daemon is ending");
	cau_order **end = &h->reads.first;
	for (; *end; end = &(*end)->next)
		its_own += (*end)->asker.client == order->asker.client;
	if (h->reads.count >= most)
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
	h->reads.count++;
	return CAU_OK;
}

// True if the next tick border comes soon anyway. Must be called after the order was queued: a
// slice that pauses the session publishes the pause before it looks for waiting requests.
static bool border_is_near(cau_hosted *h)
{
	cau_wire_session_summary summary;
	cau_hosted_summary(h, &summary);
	return summary.state == CAU_SESSION_RUNNING && summary.step_s <= BORDER_SOON_S * summary.speed;
}

cau_status cau_reads_submit(cau_hosted *h, cau_order *order, cau_error *error)
{
	if (!order->reply.answer) { // the client is gone
		free(order);
		return CAU_OK;
	}
	pthread_mutex_lock(&h->reads.lock);
	cau_status status = append(h, order, error);
	pthread_mutex_unlock(&h->reads.lock);
	if (!status && !border_is_near(h))
		cau_worker_pool_wake(h->identity.around->pool, &h->task);
	return status;
}

int32_t cau_reads_note(cau_hosted_reads *reads)
{
	pthread_mutex_lock(&reads->lock);
	int32_t count = reads->count;
	pthread_mutex_unlock(&reads->lock);
	return count;
}

cau_order *cau_reads_take(cau_hosted_reads *reads, int32_t *noted)
{
	pthread_mutex_lock(&reads->lock);
	cau_order **place = &reads->first;
	int32_t passed = 0;
	while (*place && passed < *noted && cau_reads_make_file(*place) &&
	       reads->files >= FILES_AT_ONCE) {
		place = &(*place)->next;
		passed++;
	}
	cau_order *order = passed < *noted ? *place : NULL;
	if (order) {
		*place = order->next;
		order->next = NULL;
		reads->count--;
		--*noted;
	}
	pthread_mutex_unlock(&reads->lock);
	return order;
}

void cau_reads_refuse(cau_hosted *h)
{
	pthread_mutex_lock(&h->reads.lock);
	cau_order *order = h->reads.first;
	h->reads.first = NULL;
	h->reads.count = 0;
	pthread_mutex_unlock(&h->reads.lock);
	for (cau_order *next; order; order = next) {
		next = order->next;
		cau_hosted_refuse_gone(&h->life, order);
	}
}

bool cau_reads_wait(cau_hosted_reads *reads)
{
	pthread_mutex_lock(&reads->lock);
	const cau_order *order = reads->first;
	while (order && cau_reads_make_file(order) && reads->files >= FILES_AT_ONCE)
		order = order->next;
	pthread_mutex_unlock(&reads->lock);
	return order != NULL;
}

// ---- requests that the builder answers ----------------------------------------------------------

typedef struct reading {
	cau_job job; // must be the first member
	cau_read_job read;
	cau_read_work *work;
	void (*finish)(void *copy);
} reading;

static void end(reading *r)
{
	cau_hosted *h = r->read.hosted;
	if (r->finish)
		r->finish(r->read.copy);
	if (cau_reads_make_file(r->read.order))
		atomic_fetch_sub(&h->reads.files, 1);
	free(r->read.order);
	// Other requests may have waited for the end of this request.
	cau_worker_pool_wake(h->identity.around->pool, &h->task);
	cau_hosted_release(h);
	free(r);
}

static void run(cau_job *job)
{
	reading *r = (reading *)job;
	r->work(&r->read);
	end(r);
}

static void drop(cau_job *job)
{
	reading *r = (reading *)job;
	cau_reply_fail(&r->read.order->reply, &cau_daemon_ends, CAU_RPC_DRAINING);
	end(r);
}

void cau_reads_hand_over(cau_hosted *h, cau_order *order, cau_read_work *work, void *copy,
                         void (*finish)(void *copy), double expected_s)
{
	reading *r = malloc(sizeof *r);
	if (!r) {
		if (finish)
			finish(copy);
		cau_answer_refuse(order, CAU_NO_MEMORY, "", "no memory for the answer");
		return;
	}
	*r = (reading){.job = {.run = run, .drop = drop, .expected_s = expected_s},
	               .read = {.hosted = cau_hosted_share(h),
	                        .order = order,
	                        .tick = h->core.tick,
	                        .branch = h->history.branch,
	                        .copy = copy},
	               .work = work,
	               .finish = finish};
	if (cau_reads_make_file(order))
		atomic_fetch_add(&h->reads.files, 1);
	cau_record_commit(h); // submits the records that the builder will read from the store
	cau_builder_submit(h->identity.around->builder, &r->job);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "queue.h"

#include <string.h>

#include "cautery/assert.h"
#include "clock.h"
#include "metrics.h"

// ---- submitters' side -----------------------------------------------------------------
// Called with the mutex held.
static cau_status refuse(const struct cau_store *store, size_t bytes, cau_error *error)
{
	const cau_store_config *config = &store->config;
	CAU_ASSERT(store->metrics.queue_bytes <= config->queue_bytes, "%zu bytes wait, at most %zu may",
	           store->metrics.queue_bytes, config->queue_bytes);
	if (store->closing)
		return cau_fail(error, CAU_BAD_STATE, NULL, "the store is closing");
	if (store->state == CAU_STORE_FULL)
		return cau_fail(error, CAU_IO, NULL, "%s", store->reason);
	if (store->state == CAU_STORE_DAMAGED)
		return cau_fail(error, CAU_CORRUPT, NULL, "%s", store->reason);
	if (store->metrics.queue_batches >= config->queue_batches)
		return cau_fail(error, CAU_LIMIT, NULL, "%d batches wait already", config->queue_batches);
	if (bytes > config->queue_bytes - store->metrics.queue_bytes)
		return cau_fail(error, CAU_LIMIT, NULL, "%zu bytes on top of %zu waiting; at most %zu",
		                bytes, store->metrics.queue_bytes, config->queue_bytes);
	return CAU_OK;
}

cau_status cau_store_submit(cau_store *store, cau_store_batch *batch, cau_store_callback callback,
                            void *user, cau_error *error)
{
	CAU_ASSERT(batch->next == NULL && batch->error.status == CAU_OK,
	           "a batch of %zu bytes is submitted twice", batch->bytes);
	pthread_mutex_lock(&store->mutex);
	cau_status status = refuse(store, batch->bytes, error);
	if (status) {
		store->metrics.refused_batches++;
	} else {
		batch->callback = callback;
		batch->user = user;
		batch->submitted_s = cau_store_monotonic_s();
		batch->next = NULL;
		if (store->last)
			store->last->next = batch;
		else
			store->first = batch;
		store->last = batch;
		store->submitted++;
		store->metrics.queue_batches++;
		store->metrics.queue_bytes += batch->bytes;
		pthread_cond_signal(&store->work);
	}
	pthread_mutex_unlock(&store->mutex);
	return status;
}

void cau_store_flush(cau_store *store)
{
	pthread_mutex_lock(&store->mutex);
	uint64_t target = store->submitted;
	store->flushing++;
	pthread_cond_signal(&store->work);
	while (store->answered < target)
		pthread_cond_wait(&store->answer, &store->mutex);
	store->flushing--;
	CAU_ASSERT(store->flushing >= 0, "%d batches wait for the disk", (int)store->flushing);
	pthread_mutex_unlock(&store->mutex);
}

bool cau_store_moves(cau_store *store)
{
	pthread_mutex_lock(&store->mutex);
	bool moved = !store->asked_to_move;
	store->asked_to_move = true;
	pthread_cond_signal(&store->work);
	pthread_mutex_unlock(&store->mutex);
	return moved;
}

// ---- the thread's side ----------------------------------------------------------------
static bool group_is_ripe(const struct cau_store *store, double now_s, double *due_s)
{
	CAU_ASSERT(store->first != NULL, "no group to be ripe at %g s", now_s);
	*due_s = store->first->submitted_s + 1e-3 * store->config.commit_delay_ms;
	return store->closing || store->flushing || now_s >= *due_s ||
	       store->metrics.queue_batches >= GROUP_BATCHES ||
	       store->metrics.queue_bytes >= GROUP_BYTES;
}

static double chore_due_s(const struct cau_store *store, double now_s)
{
	switch (store->state) {
	case CAU_STORE_READY:
		return store->chore_due_s;
	case CAU_STORE_FULL:
		return store->retry_due_s;
	default: // damaged: only a close is left
		return now_s + 3600.0;
	}
}

static void take_group(struct cau_store *store)
{
	CAU_ASSERT(store->first && !store->committing,
	           "a group is taken before the last is answered, in state %d", (int)store->state);
	struct cau_store_batch *last = store->first;
	size_t bytes = last->bytes;
	for (int count = 1; last->next && count < GROUP_BATCHES && bytes < GROUP_BYTES; count++) {
		last = last->next;
		bytes += last->bytes;
	}
	store->committing = store->first;
	store->first = last->next;
	if (!store->first)
		store->last = NULL;
	last->next = NULL;
	CAU_ASSERT(!store->first == !store->last, "a queue without an end, in state %d",
	           (int)store->state);
}

enum cau_store_turn cau_store_queue_await(struct cau_store *store)
{
	enum cau_store_turn turn;
	pthread_mutex_lock(&store->mutex);
	for (;;) {
		double now_s = cau_store_monotonic_s(), due_s;
		store->asked_to_move = false;
		if (store->first) {
			if (group_is_ripe(store, now_s, &due_s)) {
				take_group(store);
				turn = TURN_GROUP;
				break;
			}
		} else if (store->closing) {
			turn = TURN_END;
			break;
		} else {
			due_s = chore_due_s(store, now_s);
			if (now_s >= due_s) {
				turn = TURN_CHORE;
				break;
			}
		}
		struct timespec until = cau_store_timespec(due_s);
		pthread_cond_timedwait(&store->work, &store->mutex, &until);
	}
	pthread_mutex_unlock(&store->mutex);
	return turn;
}

void cau_store_queue_set_state(struct cau_store *store, cau_store_state state, const char *reason)
{
	pthread_mutex_lock(&store->mutex);
	bool changed = store->state != state;
	store->state = state;
	snprintf(store->reason, sizeof store->reason, "%s", reason);
	if (changed && state == CAU_STORE_FULL)
		store->metrics.full_count++;
	if (state != CAU_STORE_READY) {
		struct cau_store_batch **end = &store->committing;
		while (*end)
			end = &(*end)->next;
		*end = store->first;
		store->first = store->last = NULL;
	}
	pthread_mutex_unlock(&store->mutex);
	if (changed && store->config.on_state)
		store->config.on_state(store->config.user, state, reason);
}

// Takes the first batch out of the queue's account.
static struct cau_store_batch *pop_answered(struct cau_store *store)
{
	pthread_mutex_lock(&store->mutex);
	struct cau_store_batch *batch = store->committing;
	if (batch) {
		cau_store_metrics *metrics = &store->metrics;
		CAU_ASSERT(metrics->queue_batches > 0 && metrics->queue_bytes >= batch->bytes,
		           "%d batches of %zu bytes wait, and one of %zu is answered",
		           (int)metrics->queue_batches, metrics->queue_bytes, batch->bytes);
		store->committing = batch->next;
		metrics->queue_batches--;
		metrics->queue_bytes -= batch->bytes;
		if (batch->error.status) {
			metrics->failed_batches++;
		} else {
			metrics->batches++;
			metrics->records += batch->record_count;
			metrics->bytes += batch->bytes;
		}
		double waited_s = cau_store_monotonic_s() - batch->submitted_s;
		store->answer_time[cau_store_time_bucket(waited_s)]++;
	}
	pthread_mutex_unlock(&store->mutex);
	return batch;
}

void cau_store_queue_answer(struct cau_store *store)
{
	struct cau_store_batch *batch;
	while ((batch = pop_answered(store)) != NULL) {
		if (batch->callback)
			batch->callback(batch->user, batch->error.status, batch->error.reason);
		cau_store_batch_destroy(batch);
		pthread_mutex_lock(&store->mutex);
		store->answered++;
		CAU_ASSERT(store->answered <= store->submitted, "%llu answered of %llu",
		           (unsigned long long)store->answered, (unsigned long long)store->submitted);
		pthread_cond_broadcast(&store->answer);
		pthread_mutex_unlock(&store->mutex);
	}
}

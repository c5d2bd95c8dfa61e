// SPDX-License-Identifier: GPL-3.0-or-later
#include "store_state.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include "cautery/assert.h"

// ---- called by submitters -------------------------------------------------------------
// Returns an error if a batch of `bytes` cannot be accepted now. The caller holds the mutex.
static cau_status refuse(const struct cau_store_queue *queue, const cau_store_config *config,
                         size_t bytes, cau_error *error)
{
	CAU_ASSERT(queue->metrics.queue_bytes <= config->queue_bytes, "%zu bytes wait, at most %zu may",
	           queue->metrics.queue_bytes, config->queue_bytes);
	if (queue->closing)
		return cau_fail(error, CAU_BAD_STATE, NULL, "the store is closing");
	if (queue->state == CAU_STORE_FULL)
		return cau_fail(error, CAU_IO, NULL, "%s", queue->reason);
	if (queue->state == CAU_STORE_DAMAGED)
		return cau_fail(error, CAU_CORRUPT, NULL, "%s", queue->reason);
	if (queue->metrics.queue_batches >= config->queue_batches)
		return cau_fail(error, CAU_LIMIT, NULL, "%d batches wait already", config->queue_batches);
	if (bytes > config->queue_bytes - queue->metrics.queue_bytes)
		return cau_fail(error, CAU_LIMIT, NULL,
		                "the batch has %zu bytes and %zu bytes wait already; at most %zu may wait",
		                bytes, queue->metrics.queue_bytes, config->queue_bytes);
	return CAU_OK;
}

cau_status cau_store_submit(cau_store *store, cau_store_batch *batch, cau_store_callback callback,
                            void *user, cau_error *error)
{
	CAU_ASSERT(batch->next == NULL && batch->error.status == CAU_OK,
	           "a batch of %zu bytes is submitted twice", batch->bytes);
	struct cau_store_queue *queue = &store->queue;
	pthread_mutex_lock(&queue->mutex);
	cau_status status = refuse(queue, &store->config, batch->bytes, error);
	if (status) {
		queue->metrics.refused_batches++;
	} else {
		batch->callback = callback;
		batch->user = user;
		batch->submitted_s = cau_store_monotonic_s();
		batch->next = NULL;
		if (queue->last)
			queue->last->next = batch;
		else
			queue->first = batch;
		queue->last = batch;
		queue->submitted++;
		queue->metrics.queue_batches++;
		queue->metrics.queue_bytes += batch->bytes;
		pthread_cond_signal(&queue->work);
	}
	pthread_mutex_unlock(&queue->mutex);
	return status;
}

void cau_store_flush(cau_store *store)
{
	struct cau_store_queue *queue = &store->queue;
	pthread_mutex_lock(&queue->mutex);
	uint64_t target = queue->submitted;
	queue->flushing++;
	pthread_cond_signal(&queue->work);
	while (queue->answered < target)
		pthread_cond_wait(&queue->answer, &queue->mutex);
	queue->flushing--;
	CAU_ASSERT(queue->flushing >= 0, "%d batches wait for the disk", (int)queue->flushing);
	pthread_mutex_unlock(&queue->mutex);
}

bool cau_store_moves(cau_store *store)
{
	struct cau_store_queue *queue = &store->queue;
	pthread_mutex_lock(&queue->mutex);
	bool moved = !queue->asked_to_move;
	queue->asked_to_move = true;
	pthread_cond_signal(&queue->work);
	pthread_mutex_unlock(&queue->mutex);
	return moved;
}

// ---- called by the store thread -------------------------------------------------------
static bool group_is_ripe(const struct cau_store_queue *queue, int delay_ms, double now_s,
                          double *due_s)
{
	CAU_ASSERT(queue->first != NULL, "no group to be ripe at %g s", now_s);
	*due_s = queue->first->submitted_s + 1e-3 * delay_ms;
	return queue->closing || queue->flushing || now_s >= *due_s ||
	       queue->metrics.queue_batches >= GROUP_BATCHES ||
	       queue->metrics.queue_bytes >= GROUP_BYTES;
}

static double chore_due_s(const struct cau_store *store, double now_s)
{
	switch (store->queue.state) {
	case CAU_STORE_READY:
		return store->committer.chore_due_s;
	case CAU_STORE_FULL:
		return store->committer.retry_due_s;
	default: // damaged: the thread waits only for a close
		return now_s + 3600.0;
	}
}

static void take_group(struct cau_store_queue *queue)
{
	CAU_ASSERT(queue->first && !queue->committing,
	           "a group is taken before the last is answered, in state %d", (int)queue->state);
	struct cau_store_batch *last = queue->first;
	size_t bytes = last->bytes;
	for (int count = 1; last->next && count < GROUP_BATCHES && bytes < GROUP_BYTES; count++) {
		last = last->next;
		bytes += last->bytes;
	}
	queue->committing = queue->first;
	queue->first = last->next;
	if (!queue->first)
		queue->last = NULL;
	last->next = NULL;
	CAU_ASSERT(!queue->first == !queue->last, "a queue without an end, in state %d",
	           (int)queue->state);
}

enum cau_store_turn cau_store_queue_await(struct cau_store *store)
{
	struct cau_store_queue *queue = &store->queue;
	enum cau_store_turn turn;
	pthread_mutex_lock(&queue->mutex);
	for (;;) {
		double now_s = cau_store_monotonic_s(), due_s;
		queue->asked_to_move = false;
		if (queue->first) {
			if (group_is_ripe(queue, store->config.commit_delay_ms, now_s, &due_s)) {
				take_group(queue);
				turn = TURN_GROUP;
				break;
			}
		} else if (queue->closing) {
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
		pthread_cond_timedwait(&queue->work, &queue->mutex, &until);
	}
	pthread_mutex_unlock(&queue->mutex);
	return turn;
}

void cau_store_queue_set_state(struct cau_store *store, cau_store_state state, const char *reason)
{
	struct cau_store_queue *queue = &store->queue;
	pthread_mutex_lock(&queue->mutex);
	bool changed = queue->state != state;
	queue->state = state;
	snprintf(queue->reason, sizeof queue->reason, "%s", reason);
	if (changed && state == CAU_STORE_FULL)
		queue->metrics.full_count++;
	if (state != CAU_STORE_READY) {
		struct cau_store_batch **end = &queue->committing;
		while (*end)
			end = &(*end)->next;
		*end = queue->first;
		queue->first = queue->last = NULL;
	}
	pthread_mutex_unlock(&queue->mutex);
	if (changed && store->config.on_state)
		store->config.on_state(store->config.user, state, reason);
}

// Removes the first batch of the group and subtracts it from the queue's metrics.
static struct cau_store_batch *pop_answered(struct cau_store_queue *queue)
{
	pthread_mutex_lock(&queue->mutex);
	struct cau_store_batch *batch = queue->committing;
	if (batch) {
		cau_store_metrics *metrics = &queue->metrics;
		CAU_ASSERT(metrics->queue_batches > 0 && metrics->queue_bytes >= batch->bytes,
		           "%d batches of %zu bytes wait, and one of %zu is answered",
		           (int)metrics->queue_batches, metrics->queue_bytes, batch->bytes);
		queue->committing = batch->next;
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
		queue->answer_time[cau_store_time_bucket(waited_s)]++;
	}
	pthread_mutex_unlock(&queue->mutex);
	return batch;
}

void cau_store_queue_answer(struct cau_store_queue *queue)
{
	struct cau_store_batch *batch;
	while ((batch = pop_answered(queue)) != NULL) {
		if (batch->callback)
			batch->callback(batch->user, batch->error.status, batch->error.reason);
		cau_store_batch_destroy(batch);
		pthread_mutex_lock(&queue->mutex);
		queue->answered++;
		CAU_ASSERT(queue->answered <= queue->submitted, "%llu answered of %llu",
		           (unsigned long long)queue->answered, (unsigned long long)queue->submitted);
		pthread_cond_broadcast(&queue->answer);
		pthread_mutex_unlock(&queue->mutex);
	}
}

// ---- metrics ------------------------------------------------------------------------------------

static const double first_bucket_s = 10e-6;

double cau_store_time_bucket_s(int bucket)
{
	return first_bucket_s * exp2(0.25 * bucket);
}

int cau_store_time_bucket(double seconds)
{
	if (!(seconds > first_bucket_s))
		return 0;
	double bucket = ceil(4.0 * log2(seconds / first_bucket_s));
	return bucket < CAU_STORE_TIME_BUCKETS - 1 ? (int)bucket : CAU_STORE_TIME_BUCKETS - 1;
}

void cau_store_count_commit(struct cau_store_queue *queue, int batches, double seconds)
{
	int size = 0;
	while (size < CAU_STORE_SIZE_BUCKETS - 1 && (1 << size) < batches)
		size++;
	pthread_mutex_lock(&queue->mutex);
	queue->metrics.commits++;
	queue->metrics.group_size[size]++;
	queue->metrics.commit_s += seconds;
	queue->metrics.commit_time[cau_store_time_bucket(seconds)]++;
	pthread_mutex_unlock(&queue->mutex);
}

// Returns the upper end of the bucket that contains the given share of all counts; 0 if there are
// none.
static double quantile(const uint64_t count[CAU_STORE_TIME_BUCKETS], double share)
{
	uint64_t total = 0, seen = 0;
	for (int i = 0; i < CAU_STORE_TIME_BUCKETS; i++)
		total += count[i];
	for (int i = 0; i < CAU_STORE_TIME_BUCKETS; i++) {
		seen += count[i];
		if (seen && (double)seen >= share * (double)total)
			return cau_store_time_bucket_s(i);
	}
	return 0.0;
}

static uint64_t file_bytes(const char *path, const char *suffix)
{
	char name[4200];
	struct stat file;
	snprintf(name, sizeof name, "%s%s", path, suffix);
	return stat(name, &file) == 0 ? (uint64_t)file.st_size : 0;
}

void cau_store_get_metrics(cau_store *store, cau_store_metrics *metrics)
{
	uint64_t answer_time[CAU_STORE_TIME_BUCKETS];
	pthread_mutex_lock(&store->queue.mutex);
	*metrics = store->queue.metrics;
	memcpy(answer_time, store->queue.answer_time, sizeof answer_time);
	pthread_mutex_unlock(&store->queue.mutex);
	metrics->commit_p50_s = quantile(metrics->commit_time, 0.50);
	metrics->commit_p99_s = quantile(metrics->commit_time, 0.99);
	metrics->answer_p50_s = quantile(answer_time, 0.50);
	metrics->answer_p99_s = quantile(answer_time, 0.99);
	metrics->database_bytes = file_bytes(store->path, "");
	metrics->wal_bytes = file_bytes(store->path, "-wal");
}

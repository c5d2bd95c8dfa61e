// SPDX-License-Identifier: GPL-3.0-or-later
#include "store_state.h"

#include <string.h>
#include <sys/statvfs.h>

#include "cautery/assert.h"
#include "file.h"
#include "retention.h"

enum {
	// bytes that must be free, besides those of the failed batches, before a full store tries again
	SPARE_BYTES = 1000000,
	FOLD_PATIENCE = 4,
	CHORE_PAUSE_MS = 5, // pause between two small steps of retention
	OVERDRAWN_MS = 10,  // longest wait of a commit for retention, while the budget is exceeded
	// divisor of the budget: if usage exceeds the budget by more than 1/10 of it, commits wait
	// until usage is within the budget
	BEYOND_SHARE = 10,
	MAX_FAILED_BYTES = 1 << 30,
	// divisor of the budget: 1/100 of it may be committed between two checks of the budget
	UNSEEN_SHARE = 100,
};

// ---- one group ------------------------------------------------------------------------
// True if the error is the batch's own, so that this batch alone fails. Any other error is the
// disk's and fails the whole group.
static bool is_own_fault(cau_status status)
{
	return status == CAU_ALREADY_EXISTS || status == CAU_NOT_FOUND || status == CAU_LIMIT ||
	       status == CAU_BAD_VALUE;
}

static cau_status write_batch(struct cau_store_committer *committer, struct cau_store_batch *batch,
                              int64_t now_ms, cau_error *error)
{
	struct cau_store_uncounted before = committer->writer.uncounted;
	cau_status status = cau_store_execute(committer->database, "SAVEPOINT batch", "writing", error);
	for (const struct record *record = batch->first; record && !status; record = record->next)
		status = cau_store_writer_apply(&committer->writer, record, now_ms, error);
	if (is_own_fault(status)) {
		batch->error = *error;
		// The status is set again, because the record's function may have changed the error.
		batch->error.status = status;
		committer->writer.uncounted = before;
		status = cau_store_execute(committer->database, "ROLLBACK TO batch", "writing", error);
	}
	if (!status)
		status = cau_store_execute(committer->database, "RELEASE batch", "writing", error);
	return status;
}

static void roll_back(struct cau_store_committer *committer,
                      const struct cau_store_uncounted *before)
{
	committer->writer.uncounted = *before;
	// After some failures SQLite has already rolled back by itself.
	if (!sqlite3_get_autocommit(committer->database))
		sqlite3_exec(committer->database, "ROLLBACK", NULL, NULL, NULL);
}

// Writes and commits the group in queue.committing. A batch with an error of its own has the error
// in batch->error.
static cau_status write_group(struct cau_store *store, cau_error *error)
{
	struct cau_store_committer *committer = &store->committer;
	struct cau_store_queue *queue = &store->queue;
	uint64_t bytes = 0;
	CAU_ASSERT(queue->committing != NULL, "nothing to write, in state %d", (int)queue->state);
	int64_t now_ms = store->config.wall_clock_ms();
	int count = 0;
	struct cau_store_uncounted before = committer->writer.uncounted;
	cau_status status = cau_store_execute(committer->database, "BEGIN IMMEDIATE", "writing", error);
	for (struct cau_store_batch *batch = queue->committing; batch && !status; batch = batch->next) {
		status = write_batch(committer, batch, now_ms, error);
		bytes += batch->bytes;
		count++;
	}
	double start_s = cau_store_monotonic_s();
	if (!status)
		status = cau_store_execute(committer->database, "COMMIT", "writing", error);
	if (status)
		roll_back(committer, &before);
	else
		cau_store_count_commit(queue, count, cau_store_monotonic_s() - start_s);
	committer->unseen_bytes += status ? 0 : bytes;
	return status;
}

// Blocks the store because it cannot write. Fails the group and all waiting batches, and accepts no
// more.
static void block(struct cau_store *store, const cau_error *error)
{
	struct cau_store_committer *committer = &store->committer;
	const struct cau_store_queue *queue = &store->queue;
	CAU_ASSERT(error->status != CAU_OK, "blocked without a reason, in state %d", (int)queue->state);
	uint64_t bytes = 0;
	for (const struct cau_store_batch *batch = queue->committing; batch; batch = batch->next)
		bytes += batch->bytes;
	committer->wanted_bytes = (bytes < MAX_FAILED_BYTES ? bytes : MAX_FAILED_BYTES) + SPARE_BYTES;
	CAU_ASSERT(committer->wanted_bytes >= SPARE_BYTES, "%llu bytes are wanted",
	           (unsigned long long)committer->wanted_bytes);
	committer->retry_due_s = cau_store_monotonic_s() + 1e-3 * store->config.full_retry_ms;
	cau_store_queue_set_state(
		store, error->status == CAU_CORRUPT ? CAU_STORE_DAMAGED : CAU_STORE_FULL, error->reason);
	for (struct cau_store_batch *batch = queue->committing; batch; batch = batch->next)
		batch->error = *error;
}

static void commit_group(struct cau_store *store)
{
	cau_error error = {0};
	if (write_group(store, &error))
		block(store, &error);
	if (store->config.on_commit)
		store->config.on_commit(store->config.user);
	cau_store_queue_answer(&store->queue);
}

// ---- chores ---------------------------------------------------------------------------
// Asks for a fold of the write-ahead log into the file once the log is long, so that the log starts
// over. If commits come without a pause, the folder thread never reaches the log's end. So if the
// log is longer than FOLD_PATIENCE times the bound, commits wait for a fold.
static void fold_log(struct cau_store *store)
{
	struct cau_store_committer *committer = &store->committer;
	double now_s = cau_store_monotonic_s();
	size_t log_bytes = (size_t)committer->wal_pages * committer->page_bytes;
	if (log_bytes < store->config.wal_bytes)
		return;
	cau_store_folder_ask(&store->folder);
	if (log_bytes / FOLD_PATIENCE < store->config.wal_bytes || now_s < committer->fold_due_s)
		return;
	// after a failed fold, commits do not wait for folds until full_retry_ms have passed
	if (!cau_store_folder_wait(&store->folder))
		committer->fold_due_s = cau_store_monotonic_s() + 1e-3 * store->config.full_retry_ms;
}

// True if commits must wait for more removal. A bound on the time alone would let a slow machine
// write faster than it removes.
static bool must_shrink(const cau_store_config *config, const struct cau_store_budget *budget,
                        double until_s)
{
	int64_t most = config->store_bytes, bytes = budget->bytes;
	return bytes > most + most / BEYOND_SHARE ||
	       (bytes > most && cau_store_monotonic_s() < until_s);
}

// Takes one retention step. While the budget is exceeded, takes more, so that removal keeps pace
// with writing.
static cau_status take_steps(struct cau_store_committer *committer, const cau_store_config *config,
                             int64_t *rows, cau_error *error)
{
	double until_s = cau_store_monotonic_s() + 1e-3 * OVERDRAWN_MS;
	int64_t more = 0;
	cau_store_budget_state before = committer->budget.state;
	cau_status status;
	do {
		status =
			cau_store_retention_step(committer->database, config, &committer->budget, &more, error);
		*rows += more;
	} while (!status && more && before == CAU_STORE_BUDGET_SHRINKING &&
	         committer->budget.state == before && must_shrink(config, &committer->budget, until_s));
	return status;
}

static void retire(struct cau_store *store)
{
	struct cau_store_queue *queue = &store->queue;
	struct cau_store_committer *committer = &store->committer;
	CAU_ASSERT(queue->state == CAU_STORE_READY, "retention in state %d", (int)queue->state);
	cau_error error = {0};
	int64_t rows = 0;
	int pause_ms = store->config.retention_interval_ms;
	cau_store_budget_state before = committer->budget.state;
	committer->unseen_bytes = 0;
	cau_status status = take_steps(committer, &store->config, &rows, &error);
	if (status == CAU_CORRUPT) {
		block(store, &error);
		cau_store_queue_answer(queue);
	}
	CAU_ASSERT(rows >= 0, "%lld rows retired", (long long)rows);
	if (!status) {
		pthread_mutex_lock(&queue->mutex);
		queue->metrics.retired_rows += (uint64_t)rows;
		queue->metrics.kept_bytes = (uint64_t)committer->budget.bytes;
		queue->metrics.budget_dropped = (uint64_t)committer->budget.dropped;
		queue->metrics.budget = committer->budget.state;
		pthread_mutex_unlock(&queue->mutex);
	}
	if (!status && rows)
		pause_ms = CHORE_PAUSE_MS;
	if (!status && committer->budget.state != before && store->config.on_budget)
		store->config.on_budget(store->config.user, committer->budget.state,
		                        committer->budget.bytes, committer->budget.dropped);
	committer->chore_due_s = cau_store_monotonic_s() + 1e-3 * pause_ms;
}

// True if a retention step is due. After many written bytes the step is due earlier, so that the
// budget is not exceeded between two checks.
static bool chore_is_due(const struct cau_store_committer *committer, int64_t most, double now_s)
{
	return now_s >= committer->chore_due_s ||
	       (most && committer->unseen_bytes >= (uint64_t)most / UNSEEN_SHARE);
}

static bool has_room(const struct cau_store *store)
{
	struct statvfs disk;
	if (store->config.memory) // retention may have freed memory, so a store in memory always tries
		return true;
	return statvfs(store->path, &disk) == 0 &&
	       (uint64_t)disk.f_bavail * disk.f_frsize >= store->committer.wanted_bytes;
}

// Tries once to write while the store is full. A failed commit may have left the log long; a fold
// frees those bytes.
static void try_again(struct cau_store *store)
{
	struct cau_store_queue *queue = &store->queue;
	sqlite3 *database = store->committer.database;
	CAU_ASSERT(queue->state == CAU_STORE_FULL, "tried again in state %d", (int)queue->state);
	cau_error error = {0};
	char sql[128];
	store->committer.retry_due_s = cau_store_monotonic_s() + 1e-3 * store->config.full_retry_ms;
	pthread_mutex_lock(&queue->mutex);
	queue->metrics.full_attempts++;
	pthread_mutex_unlock(&queue->mutex);
	sqlite3_wal_checkpoint_v2(database, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL, NULL);
	if (!has_room(store))
		return;
	snprintf(sql, sizeof sql, "REPLACE INTO meta VALUES('recovered_ms', %lld)",
	         (long long)store->config.wall_clock_ms());
	cau_status status = cau_store_execute(database, sql, "trying again", &error);
	if (status == CAU_CORRUPT)
		cau_store_queue_set_state(store, CAU_STORE_DAMAGED, error.reason);
	else if (!status)
		cau_store_queue_set_state(store, CAU_STORE_READY, "");
}

void *cau_store_commit_run(void *context)
{
	struct cau_store *store = context;
	pthread_setname_np(pthread_self(), store->config.memory ? "cautery-memory" : "cautery-store");
	for (;;) {
		switch (cau_store_queue_await(store)) {
		case TURN_GROUP:
			commit_group(store);
			break;
		case TURN_CHORE:
			break;
		case TURN_END:
			return NULL;
		}
		// Only this thread changes the state, so it is read without the mutex.
		double now_s = cau_store_monotonic_s();
		if (store->queue.state == CAU_STORE_FULL && now_s >= store->committer.retry_due_s)
			try_again(store);
		if (store->queue.state != CAU_STORE_READY)
			continue;
		fold_log(store);
		if (chore_is_due(&store->committer, store->config.store_bytes, now_s))
			retire(store);
	}
}

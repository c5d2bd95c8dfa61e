// SPDX-License-Identifier: GPL-3.0-or-later
// Opens and closes the store.
#include <libgen.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "file.h"
#include "store_state.h"

static const int64_t hour_ms = 3600000;

static int64_t system_clock_ms(void)
{
	struct timespec now;
	clock_gettime(CLOCK_REALTIME, &now);
	return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

cau_store_config cau_store_default_config(void)
{
	return (cau_store_config){
		.commit_delay_ms = 5,
		.queue_batches = 4096,
		.queue_bytes = 256000000,
		.full_retry_ms = 1000,
		.retention_bytes = 1000000000,
		.retention_age_ms = 24 * hour_ms,
		.answer_age_ms = 24 * hour_ms,
		.event_age_ms = 30 * 24 * hour_ms,
		.retention_interval_ms = 10000,
		.wal_bytes = 16000000,
		.wall_clock_ms = system_clock_ms,
	};
}

const char *cau_store_state_name(cau_store_state state)
{
	static const char *const names[] = {
#define X(code, name) name,
		CAU_STORE_STATE_TABLE(X)
#undef X
	};
	return (unsigned)state < CAU_STORE_STATE_COUNT ? names[state] : "unknown";
}

// ---- configuration --------------------------------------------------------------------
static cau_status check_range(const char *path, int64_t value, int64_t least, int64_t most,
                              cau_error *error)
{
	if (value < least || value > most)
		return cau_fail(error, CAU_BAD_VALUE, path, "%lld is not within %lld to %lld",
		                (long long)value, (long long)least, (long long)most);
	return CAU_OK;
}

static cau_status check_config(const cau_store_config *config, cau_error *error)
{
	const struct {
		const char *path;
		int64_t value, least, most;
	} ranges[] = {
		{"commit_delay_ms", config->commit_delay_ms, 0, 10},
		{"queue_batches", config->queue_batches, 1, INT32_MAX},
		{"queue_bytes", (int64_t)config->queue_bytes, 1, INT64_MAX},
		{"full_retry_ms", config->full_retry_ms, 1, INT32_MAX},
		{"retention_bytes", config->retention_bytes, 0, INT64_MAX},
		{"store_bytes", config->store_bytes, 0, INT64_MAX},
		{"retention_age_ms", config->retention_age_ms, 0, INT64_MAX},
		{"answer_age_ms", config->answer_age_ms, 0, INT64_MAX},
		{"event_age_ms", config->event_age_ms, 0, INT64_MAX},
		{"retention_interval_ms", config->retention_interval_ms, 1, INT32_MAX},
		{"wal_bytes", (int64_t)config->wal_bytes, 0, INT64_MAX},
	};
	if (!config->memory && (!config->path || !config->path[0]))
		return cau_fail(error, CAU_BAD_VALUE, "path", "is missing");
	if (config->label && strnlen(config->label, CAU_STORE_ID_BYTES) == CAU_STORE_ID_BYTES)
		return cau_fail(error, CAU_BAD_VALUE, "label", "is longer than %d bytes",
		                CAU_STORE_ID_BYTES - 1);
	for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
		cau_status status =
			check_range(ranges[i].path, ranges[i].value, ranges[i].least, ranges[i].most, error);
		if (status)
			return status;
	}
	return CAU_OK;
}

// Finds the one absolute name of a file, with links followed. The file need not exist.
static cau_status find_path(const char *given, char path[4096], cau_error *error)
{
	char folder[PATH_MAX], resolved[PATH_MAX], name[PATH_MAX];
	if (strlen(given) >= sizeof folder)
		return cau_fail(error, CAU_BAD_VALUE, "path", "is longer than %zu bytes",
		                sizeof folder - 1);
	if (realpath(given, resolved)) {
		snprintf(path, 4096, "%s", resolved);
		return CAU_OK;
	}
	snprintf(folder, sizeof folder, "%s", given);
	snprintf(name, sizeof name, "%s", given);
	if (!realpath(dirname(folder), resolved))
		return cau_fail(error, CAU_IO, "path", "no folder %s", folder);
	if ((size_t)snprintf(path, 4096, "%s/%s", resolved, basename(name)) >= 4096)
		return cau_fail(error, CAU_BAD_VALUE, "path",
		                "is longer than 4095 bytes after its links are followed");
	return CAU_OK;
}

// ---- opening --------------------------------------------------------------------------
static int count_wal_pages(void *context, sqlite3 *database, const char *name, int pages)
{
	(void)database, (void)name;
	((struct cau_store_committer *)context)->wal_pages = pages;
	return SQLITE_OK;
}

// Stores the label if none is stored. A stored label stays.
static cau_status settle_label(struct cau_store *store, cau_error *error)
{
	sqlite3 *database = store->committer.database;
	sqlite3_stmt *statement = NULL;
	int code = SQLITE_OK;
	if (store->config.label) {
		code = sqlite3_prepare_v2(database, "INSERT OR IGNORE INTO meta VALUES('label', ?1)", -1,
		                          &statement, NULL);
		if (!code) {
			sqlite3_bind_text(statement, 1, store->config.label, -1, SQLITE_STATIC);
			sqlite3_step(statement);
			code = sqlite3_finalize(statement);
		}
	}
	if (!code)
		code = sqlite3_prepare_v2(database, "SELECT value FROM meta WHERE name = 'label'", -1,
		                          &statement, NULL);
	if (!code && sqlite3_step(statement) == SQLITE_ROW)
		snprintf(store->label, sizeof store->label, "%s",
		         (const char *)sqlite3_column_text(statement, 0));
	if (!code)
		code = sqlite3_finalize(statement);
	return code ? cau_store_fault(database, code, "the label", error) : CAU_OK;
}

// Stores the path beside which the write-ahead log is. After a crash, the probe refuses another
// name of the file.
static cau_status note_path(struct cau_store *store, cau_error *error)
{
	sqlite3 *database = store->committer.database;
	sqlite3_stmt *statement = NULL;
	int code = sqlite3_prepare_v2(database,
	                              "INSERT INTO meta VALUES('path', ?1) ON CONFLICT(name) DO UPDATE"
	                              " SET value = excluded.value WHERE value <> excluded.value",
	                              -1, &statement, NULL);
	if (!code)
		code = sqlite3_bind_text(statement, 1, store->path, -1, SQLITE_STATIC);
	if (!code)
		sqlite3_step(statement);
	code = code ? code : sqlite3_finalize(statement);
	return code ? cau_store_fault(database, code, "the path", error) : CAU_OK;
}

// Refuses a new label with `-`. Ids of sessions are LABEL-NAME, so the end of the label must be
// clear. ROS 2 names allow no `-`, and two labels must not become the same name. A store that
// already has such a label keeps it.
static cau_status check_new_label(const char *label, cau_error *error)
{
	if (label && strchr(label, '-'))
		return cau_fail(error, CAU_BAD_VALUE, "label",
		                "`%.48s` has a `-`, which a new store's label may not have", label);
	return CAU_OK;
}

// Prepares a store that is open for writing, in a file or in memory.
static cau_status prepare(struct cau_store *store, cau_error *error)
{
	sqlite3 *database = store->committer.database;
	int64_t page_bytes = 0;
	cau_status status = cau_store_migrate(database, error);
	if (!status)
		status = settle_label(store, error);
	if (!status)
		status = note_path(store, error);
	if (!status)
		status = cau_store_integer(database, "PRAGMA page_size", &page_bytes, error);
	store->committer.page_bytes = (size_t)page_bytes;
	return status;
}

// Opens a store in memory. Its connections share one SQLite database, which has no write-ahead log
// to fold.
static cau_status open_memory(struct cau_store *store, cau_error *error)
{
	struct cau_store_committer *committer = &store->committer;
	sqlite3 **const further[] = {&store->reading.database, &store->answers.database};
	// Largest size of the database in memory, bytes. Retention keeps the database below this size,
	// which is twice the budget.
	int64_t most = 2 * store->config.store_bytes;
	snprintf(store->path, sizeof store->path, "file:/cautery-%p?vfs=memdb", (void *)store);
	cau_status status = cau_store_memory_open(store->path, most, &committer->database, error);
	if (!status)
		status = prepare(store, error);
	if (!status)
		status = cau_store_writer_init(&committer->writer, committer->database, error);
	for (size_t i = 0; i < sizeof further / sizeof *further && !status; i++)
		status = cau_store_memory_open(store->path, most, further[i], error);
	return status;
}

// Makes or checks the file, opens the connections, and migrates. The caller holds the lock.
static cau_status open_database(struct cau_store *store, cau_error *error)
{
	struct cau_store_committer *committer = &store->committer;
	enum cau_store_found found;
	cau_status status = cau_store_lock_database(&store->lock, store->path, error);
	if (!status)
		status = cau_store_probe(store->path, store->config.label, &found, error);
	if (!status && found == CAU_STORE_ABSENT) {
		status = check_new_label(store->config.label, error);
		if (!status)
			status = cau_store_file_create(store->path, error);
		if (!status)
			status = cau_store_lock_database(&store->lock, store->path, error);
	}
	if (!status)
		status =
			cau_store_file_open(store->path, store->config.wal_bytes, &committer->database, error);
	if (status)
		return status;
	sqlite3_wal_hook(committer->database, count_wal_pages, committer);
	status = prepare(store, error);
	// Folds the log into the file, so that the file alone shows its schema. A failure is ignored,
	// so that a full disk does not prevent a start.
	if (!status)
		sqlite3_wal_checkpoint_v2(committer->database, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL,
		                          NULL);
	if (!status)
		status = cau_store_writer_init(&committer->writer, committer->database, error);
	if (!status)
		status = cau_store_file_open_reader(store->path, &store->reading.database, error);
	if (!status)
		status = cau_store_file_open_reader(store->path, &store->answers.database, error);
	if (!status)
		status = cau_store_file_open(store->path, store->config.wal_bytes, &store->folding, error);
	return status;
}

static cau_status open_on_disk(struct cau_store *store, cau_error *error)
{
	cau_status status = find_path(store->config.path, store->path, error);
	if (!status)
		status = cau_store_lock_take(&store->lock, store->path, error);
	return status ? status : open_database(store, error);
}

static void close_database(struct cau_store *store)
{
	cau_store_writer_finish(&store->committer.writer);
	sqlite3_close(store->reading.database);
	sqlite3_close(store->answers.database);
	sqlite3_close(store->folding);
	// the last connection to close folds the log and removes it
	sqlite3_close(store->committer.database);
	cau_store_lock_release(&store->lock);
}

static void init_locks(struct cau_store *store)
{
	pthread_condattr_t monotonic;
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&store->queue.work, &monotonic);
	pthread_condattr_destroy(&monotonic);
	pthread_cond_init(&store->queue.answer, NULL);
	pthread_mutex_init(&store->queue.mutex, NULL);
	pthread_mutex_init(&store->reading.mutex, NULL);
	pthread_mutex_init(&store->answers.mutex, NULL);
}

static void destroy(struct cau_store *store)
{
	close_database(store);
	pthread_cond_destroy(&store->queue.work);
	pthread_cond_destroy(&store->queue.answer);
	pthread_mutex_destroy(&store->queue.mutex);
	pthread_mutex_destroy(&store->reading.mutex);
	pthread_mutex_destroy(&store->answers.mutex);
	free(store);
}

static cau_status start_threads(struct cau_store *store, cau_error *error)
{
	bool folds = !store->config.memory;
	int code = folds ? cau_store_folder_start(&store->folder, store->folding) : 0;
	if (code)
		return cau_fail(
			error, CAU_NO_MEMORY, NULL,
			"cannot start the thread that checkpoints the write-ahead log: %s (its limit: "
			"ulimit -u)",
			strerrordesc_np(code));
	code = pthread_create(&store->thread, NULL, cau_store_commit_run, store);
	if (code) {
		if (folds)
			cau_store_folder_stop(&store->folder);
		return cau_fail(error, CAU_NO_MEMORY, NULL,
		                "cannot start the store's commit thread: %s (its limit: ulimit -u)",
		                strerrordesc_np(code));
	}
	return CAU_OK;
}

cau_status cau_store_open(const cau_store_config *config, cau_store **out, cau_error *error)
{
	cau_error local;
	if (!error)
		error = &local;
	snprintf(error->file, sizeof error->file, "%s", config->path ? config->path : "");
	cau_status status = check_config(config, error);
	if (status)
		return status;
	struct cau_store *store = calloc(1, sizeof *store);
	if (!store)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "opening the store");
	store->config = *config;
	store->lock.descriptor = store->lock.database = -1;
	if (!store->config.wall_clock_ms)
		store->config.wall_clock_ms = system_clock_ms;
	init_locks(store);
	status = config->memory ? open_memory(store, error) : open_on_disk(store, error);
	store->config.path = store->path;
	store->config.label = store->label;
	store->committer.chore_due_s =
		cau_store_monotonic_s() + 1e-3 * store->config.retention_interval_ms;
	if (!status)
		status = start_threads(store, error);
	if (status)
		destroy(store);
	else
		*out = store;
	return status;
}

void cau_store_close(cau_store *store)
{
	if (!store)
		return;
	pthread_mutex_lock(&store->queue.mutex);
	store->queue.closing = true;
	pthread_cond_signal(&store->queue.work);
	pthread_mutex_unlock(&store->queue.mutex);
	pthread_join(store->thread, NULL);
	if (!store->config.memory)
		cau_store_folder_stop(&store->folder);
	destroy(store);
}

const char *cau_store_label(const cau_store *store)
{
	return store->label;
}

void cau_store_get_health(cau_store *store, cau_store_health *health)
{
	struct cau_store_queue *queue = &store->queue;
	pthread_mutex_lock(&queue->mutex);
	health->state =
		queue->closing && queue->state == CAU_STORE_READY ? CAU_STORE_CLOSING : queue->state;
	snprintf(health->reason, sizeof health->reason, "%s", queue->reason);
	pthread_mutex_unlock(&queue->mutex);
}

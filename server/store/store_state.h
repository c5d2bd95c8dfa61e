// SPDX-License-Identifier: GPL-3.0-or-later
// The private structs of the store, and the functions that its files share. Each struct says which
// thread owns its members, and which lock guards them.
#pragma once

#include <pthread.h>
#include <sqlite3.h>
#include <stdint.h>
#include <time.h>

#include "batch.h"
#include "file.h"
#include "retention.h"

// ---- the clock ----------------------------------------------------------------------------------

// Returns the seconds of the monotonic clock.
static inline double cau_store_monotonic_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static inline struct timespec cau_store_timespec(double monotonic_s)
{
	struct timespec time = {.tv_sec = (time_t)monotonic_s};
	time.tv_nsec = (long)((monotonic_s - (double)time.tv_sec) * 1e9);
	return time;
}

// ---- structs ------------------------------------------------------------------------------------

enum {
	GROUP_BATCHES = 1024, // largest number of batches in one commit
	// bytes of a full commit: the batch with which a commit reaches them is its last batch
	GROUP_BYTES = 16 * 1000000,
};

// A connection for reading, guarded by `mutex`.
struct cau_store_reader {
	pthread_mutex_t mutex;
	sqlite3 *database;
};

// State of commits, retention, and attempts while the disk is full. Used by the store thread only.
// commit.c.
struct cau_store_committer {
	sqlite3 *database;
	struct cau_store_writer writer;
	size_t page_bytes;
	int wal_pages;      // pages in the log after the last commit
	double fold_due_s;  // monotonic time before which commits do not wait for a fold again
	double chore_due_s; // monotonic time of the next retention step
	struct cau_store_budget budget;
	uint64_t unseen_bytes; // bytes committed since the last retention step
	double retry_due_s;    // monotonic time of the next attempt while full
	uint64_t wanted_bytes; // bytes that must be free for an attempt while full
};

// Batches on their way to the disk, and the store's state and metrics, guarded by `mutex`. Only the
// store thread changes `committing` and `state`, and it reads both without the lock. queue.c.
struct cau_store_queue {
	pthread_mutex_t mutex;
	pthread_cond_t work;                  // signals a batch, a flush or a close
	pthread_cond_t answer;                // signals that a batch was answered
	struct cau_store_batch *first, *last; // waiting batches
	struct cau_store_batch *committing;   // taken by the store thread, not yet answered
	uint64_t submitted, answered;         // numbers of batches since open
	int flushing;                         // callers inside cau_store_flush()
	// cau_store_moves() was called, and the store thread has not looked for work since
	bool asked_to_move;
	bool closing;
	cau_store_state state; // READY, FULL or DAMAGED
	char reason[320];
	// only the counters, the histograms, queue_batches and queue_bytes are kept here
	cau_store_metrics metrics;
	uint64_t answer_time[CAU_STORE_TIME_BUCKETS];
};

struct cau_store {
	// These members do not change after open.
	cau_store_config config;
	char path[4096]; // absolute path
	char label[CAU_STORE_ID_BYTES];
	struct cau_store_lock lock;
	pthread_t thread;
	struct cau_store_folder folder;
	sqlite3 *folding; // the folder thread's connection

	struct cau_store_committer committer;
	struct cau_store_reader reading;
	// a connection of its own: a search for an answer never waits for a long read
	struct cau_store_reader answers;
	struct cau_store_queue queue;
};

// ---- the store's thread (commit.c) --------------------------------------------------------------

// Runs the store thread. `store` is a struct cau_store.
void *cau_store_commit_run(void *store);

// ---- the queue (queue.c) ------------------------------------------------------------------------
// The bounded queue between submitters and the store thread.

enum cau_store_turn {
	TURN_GROUP, // queue.committing holds a group
	TURN_CHORE, // nothing to commit; a chore or an attempt while full is due
	TURN_END,   // the store is closing, and the queue is empty
};

// Waits until the store thread has something to do. A batch waits for others until commit_delay_ms
// after its submission.
enum cau_store_turn cau_store_queue_await(struct cau_store *store);

// Changes the state. Unless the new state is READY, appends every waiting batch to
// queue.committing.
void cau_store_queue_set_state(struct cau_store *store, cau_store_state state, const char *reason);

// Calls the callback of each batch in queue.committing, in order, and frees the batches.
void cau_store_queue_answer(struct cau_store_queue *queue);

// ---- metrics (queue.c) --------------------------------------------------------------------------
// Histograms of the store's metrics.

// Returns the bucket of a duration, 0 to CAU_STORE_TIME_BUCKETS - 1. The last bucket has all longer
// durations.
int cau_store_time_bucket(double seconds);

// Counts one commit of a group of `batches`.
void cau_store_count_commit(struct cau_store_queue *queue, int batches, double seconds);

// ---- reads (read.c) -----------------------------------------------------------------------------
// Shared functions of the reads. The caller of each holds the reader's mutex.

cau_status cau_store_prepare(struct cau_store_reader *reader, const char *sql,
                             sqlite3_stmt **statement, cau_error *error);
// Advances to the next row. At the end returns CAU_NOT_FOUND, without filling *error.
cau_status cau_store_next_row(struct cau_store_reader *reader, sqlite3_stmt *statement,
                              cau_error *error);
cau_status cau_store_end_is_fine(cau_status status); // turns CAU_NOT_FOUND into CAU_OK
const char *cau_store_column_text(sqlite3_stmt *statement, int column);
cau_status cau_store_find_session(struct cau_store_reader *reader, const char *id, int64_t *key,
                                  cau_error *error);

// One branch of the line to the root, with the ticks that the line takes from it. before_tick is
// where the next branch forks from it.
struct cau_store_stretch {
	int64_t branch;
	int64_t from_tick, before_tick;
};

// Fills *line (the caller frees it with free()) from the branch up to the root. Each stretch is
// later than the one after it.
cau_status cau_store_find_line(struct cau_store_reader *reader, int64_t key, int64_t branch,
                               struct cau_store_stretch **line, int *count, cau_error *error);

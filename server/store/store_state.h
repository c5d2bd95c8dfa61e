// SPDX-License-Identifier: GPL-3.0-or-later
// The private structs of the store: which thread owns each member, and which lock guards it.
#pragma once

#include <pthread.h>
#include <sqlite3.h>

#include "batch.h"
#include "fold.h"
#include "lock.h"
#include "retention.h"
#include "write.h"

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

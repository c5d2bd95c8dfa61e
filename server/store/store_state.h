// SPDX-License-Identifier: GPL-3.0-or-later
// The store's insides: who owns what, and under which lock.
#pragma once

#include <pthread.h>
#include <sqlite3.h>

#include "batch.h"
#include "fold.h"
#include "lock.h"
#include "retention.h"
#include "write.h"

enum {
	GROUP_BATCHES = 1024,       // most batches in one commit
	GROUP_BYTES = 16 * 1000000, // a commit ends with the batch that reaches this
};

// A connection for reading, under the lock `mutex`.
struct cau_store_reader {
	pthread_mutex_t mutex;
	sqlite3 *database;
};

// Commits, retention, and attempts while the disk is full; the store thread's alone. commit.c.
struct cau_store_committer {
	sqlite3 *database;
	struct cau_store_writer writer;
	size_t page_bytes;
	int wal_pages;      // in the log after the last commit
	double fold_due_s;  // monotonic: the log is not folded here before
	double chore_due_s; // monotonic: next look for something to remove
	struct cau_store_budget budget;
	uint64_t unseen_bytes; // committed since retention's last look
	double retry_due_s;    // monotonic: next attempt while full
	uint64_t wanted_bytes; // free space that an attempt while full asks for
};

// Batches on their way to the disk, and the store's state and metrics, under the lock `mutex`. The
// store thread alone changes `committing` and `state`, and reads both without the lock. queue.c.
struct cau_store_queue {
	pthread_mutex_t mutex;
	pthread_cond_t work;                  // a batch, a flush, a close
	pthread_cond_t answer;                // a batch was answered
	struct cau_store_batch *first, *last; // waiting
	struct cau_store_batch *committing;   // taken by the store thread, not yet answered
	uint64_t submitted, answered;         // since open
	int flushing;                         // callers inside cau_store_flush()
	bool asked_to_move;                   // cau_store_moves(): not come round since
	bool closing;
	cau_store_state state; // READY, FULL or DAMAGED
	char reason[320];
	cau_store_metrics metrics; // its counters and histograms, queue_batches and queue_bytes
	uint64_t answer_time[CAU_STORE_TIME_BUCKETS];
};

struct cau_store {
	// Fixed after open.
	cau_store_config config;
	char path[4096]; // absolute
	char label[CAU_STORE_ID_BYTES];
	struct cau_store_lock lock;
	pthread_t thread;
	struct cau_store_folder folder;
	sqlite3 *folding; // the folder's connection

	struct cau_store_committer committer;
	struct cau_store_reader reading;
	struct cau_store_reader answers; // looking for an answer never waits for a long reading
	struct cau_store_queue queue;
};

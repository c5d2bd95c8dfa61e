// SPDX-License-Identifier: GPL-3.0-or-later
// Folds the write-ahead log into the database file, on a thread and a connection of its own.
// Folding a long log takes many times as long as a commit, and commits must not wait for it.
#pragma once

#include <pthread.h>
#include <sqlite3.h>
#include <stdbool.h>

struct cau_store_folder {
	sqlite3 *database; // borrowed; used by the thread only, once it runs
	pthread_t thread;
	pthread_mutex_t mutex; // guards the members below
	pthread_cond_t work, idle;
	bool asked, folding, closing;
	bool complete; // the last fold reached the end of the log
};

// Starts the thread. Returns 0 or the error code of pthread_create().
int cau_store_folder_start(struct cau_store_folder *folder, sqlite3 *database);

// Asks for a fold and does not wait. A request during a fold starts another fold after it.
void cau_store_folder_ask(struct cau_store_folder *folder);

// Waits until all requested folds are done. Returns false if the last fold did not reach the log's
// end, because the disk refuses or a reader holds the log.
bool cau_store_folder_wait(struct cau_store_folder *folder);

// Waits for a running fold, then ends the thread.
void cau_store_folder_stop(struct cau_store_folder *folder);

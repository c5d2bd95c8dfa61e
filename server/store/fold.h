// SPDX-License-Identifier: GPL-3.0-or-later
// Folds the write-ahead log into the database file, on a thread and a connection of its own:
// folding a long log takes many times as long as a commit, which must not wait for it.
#pragma once

#include <pthread.h>
#include <sqlite3.h>
#include <stdbool.h>

struct cau_store_folder {
	sqlite3 *database; // the thread's, once it runs; borrowed
	pthread_t thread;
	pthread_mutex_t mutex; // guards what follows
	pthread_cond_t work, idle;
	bool asked, folding, closing;
	bool complete; // the last fold reached the log's end
};

// Starts the thread. 0, or pthread_create()'s code.
int cau_store_folder_start(struct cau_store_folder *folder, sqlite3 *database);

// Asks for a fold and does not wait. Asking while one runs asks for one more.
void cau_store_folder_ask(struct cau_store_folder *folder);

// Waits until nothing asked for is left to do. False if the last fold did not reach the log's end:
// the disk refuses, or a reader holds the log.
bool cau_store_folder_wait(struct cau_store_folder *folder);

// Waits for a running fold and ends the thread.
void cau_store_folder_stop(struct cau_store_folder *folder);

// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/assert.h"
#include "file.h"

// Folds the log. PASSIVE never holds up a commit. If the fold fails, the commits are still safe in
// the log, and the fold is requested again later.
static bool fold(sqlite3 *database)
{
	int pages = 0, folded = 0;
	int code =
		sqlite3_wal_checkpoint_v2(database, NULL, SQLITE_CHECKPOINT_PASSIVE, &pages, &folded);
	return code == SQLITE_OK && folded == pages;
}

static void *run(void *context)
{
	struct cau_store_folder *folder = context;
	pthread_setname_np(pthread_self(), "cautery-fold");
	pthread_mutex_lock(&folder->mutex);
	while (!folder->closing) {
		if (!folder->asked) {
			pthread_cond_wait(&folder->work, &folder->mutex);
			continue;
		}
		folder->asked = false;
		folder->folding = true;
		pthread_mutex_unlock(&folder->mutex);
		bool complete = fold(folder->database);
		pthread_mutex_lock(&folder->mutex);
		folder->folding = false;
		folder->complete = complete;
		pthread_cond_broadcast(&folder->idle);
	}
	pthread_mutex_unlock(&folder->mutex);
	return NULL;
}

int cau_store_folder_start(struct cau_store_folder *folder, sqlite3 *database)
{
	*folder = (struct cau_store_folder){.database = database};
	pthread_mutex_init(&folder->mutex, NULL);
	pthread_cond_init(&folder->work, NULL);
	pthread_cond_init(&folder->idle, NULL);
	int code = pthread_create(&folder->thread, NULL, run, folder);
	if (code) {
		pthread_cond_destroy(&folder->work);
		pthread_cond_destroy(&folder->idle);
		pthread_mutex_destroy(&folder->mutex);
	}
	return code;
}

void cau_store_folder_ask(struct cau_store_folder *folder)
{
	pthread_mutex_lock(&folder->mutex);
	CAU_ASSERT(!folder->closing, "asked to fold while it ends: %d", folder->closing);
	folder->asked = true;
	pthread_cond_signal(&folder->work);
	pthread_mutex_unlock(&folder->mutex);
}

bool cau_store_folder_wait(struct cau_store_folder *folder)
{
	pthread_mutex_lock(&folder->mutex);
	while (folder->asked || folder->folding)
		pthread_cond_wait(&folder->idle, &folder->mutex);
	bool complete = folder->complete;
	pthread_mutex_unlock(&folder->mutex);
	return complete;
}

void cau_store_folder_stop(struct cau_store_folder *folder)
{
	pthread_mutex_lock(&folder->mutex);
	CAU_ASSERT(!folder->closing, "ended twice: %d", folder->closing);
	folder->closing = true;
	pthread_cond_signal(&folder->work);
	pthread_mutex_unlock(&folder->mutex);
	pthread_join(folder->thread, NULL);
	pthread_cond_destroy(&folder->work);
	pthread_cond_destroy(&folder->idle);
	pthread_mutex_destroy(&folder->mutex);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Allows one process per store, whatever names its file has. There are two locks. The first is on a
// file beside the database, which names the holder and exists before the database does. The second
// is on the database itself, which a hard link, a bind mount or another path reaches as well.
#pragma once

#include <sys/types.h>

#include "cautery/status.h"

struct cau_store_lock {
	int descriptor; // descriptor of the lock file; -1: not held
	char path[4096];
	int database; // descriptor that holds the lock on the database; -1: not held
	dev_t device;
	ino_t inode;
	struct cau_store_lock *next; // next lock that this process holds
};

// Takes the lock of the store at `path`. If it is taken, returns CAU_BAD_STATE and names the
// holder. The struct must not move in memory until the lock is released.
cau_status cau_store_lock_take(struct cau_store_lock *lock, const char *path, cau_error *error);

// Takes the lock of the database itself once the database exists. Does nothing if there is no
// database, or if this lock already holds it. Returns CAU_BAD_STATE if another process, or another
// store of this process, has the database open under any name.
cau_status cau_store_lock_database(struct cau_store_lock *lock, const char *path, cau_error *error);

// Releases both locks and removes the lock file. Does nothing if the lock is not held. Call it only
// after SQLite has closed the database: closing any descriptor of the database drops SQLite's locks
// on it.
void cau_store_lock_release(struct cau_store_lock *lock);

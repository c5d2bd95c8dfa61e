// SPDX-License-Identifier: GPL-3.0-or-later
// One process per store, whatever names its file has. Two locks: one on a file beside the database,
// which names its holder and is there before the database is; and one on the database itself, which
// a hard link, a bind mount or another path leads to as well.
#pragma once

#include <sys/types.h>

#include "cautery/status.h"

struct cau_store_lock {
	int descriptor; // of the lock file; -1: not held
	char path[4096];
	int database; // a descriptor of the database, whose lock goes with it; -1: not held
	dev_t device;
	ino_t inode;
	struct cau_store_lock *next; // of those that this process holds
};

// Takes the lock of the store at `path`, which names its holder if it is taken (CAU_BAD_STATE). The
// lock must stay where it is in memory until it is released.
cau_status cau_store_lock_take(struct cau_store_lock *lock, const char *path, cau_error *error);

// Takes the lock of the database itself, once it is there; does nothing if it is not, or is held by
// this lock already. CAU_BAD_STATE if another process, or another store of this one, has it open
// under any name.
cau_status cau_store_lock_database(struct cau_store_lock *lock, const char *path, cau_error *error);

// Lets go and removes the lock file. Does nothing if the lock is not held. Only once SQLite has
// closed the database: closing any descriptor of it drops the locks that SQLite holds on it.
void cau_store_lock_release(struct cau_store_lock *lock);

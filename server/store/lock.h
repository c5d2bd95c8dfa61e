// SPDX-License-Identifier: GPL-3.0-or-later
// One process per store: an advisory lock on a file beside the database. A file of its own, because
// closing any descriptor of the database itself would drop the locks that SQLite holds on it.
#pragma once

#include "cautery/status.h"

struct cau_store_lock {
	int descriptor; // -1: not held
	char path[4096];
};

// Takes the lock of the store at `path`, which names its holder if it is taken (CAU_BAD_STATE).
cau_status cau_store_lock_take(struct cau_store_lock *lock, const char *path, cau_error *error);

// Lets go and removes the file. Does nothing if the lock is not held.
void cau_store_lock_release(struct cau_store_lock *lock);

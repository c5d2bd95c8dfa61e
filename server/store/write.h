// SPDX-License-Identifier: GPL-3.0-or-later
// Writes records into the database, inside a transaction of the caller's.
#pragma once

#include <sqlite3.h>

#include "batch.h"

enum {
	CAU_STORE_STATEMENTS = 20,
	CAU_STORE_UNCOUNTED_SLOTS = 16, // branches that are written to at a time, more or less
};

// Bytes of commands that branches.bytes does not count yet. Counting with each command would write
// the page of branches with each commit. A crash loses these bytes, less than a page a branch.
struct cau_store_uncounted {
	struct {
		int64_t key, branch, bytes; // bytes 0: the slot is free
	} slot[CAU_STORE_UNCOUNTED_SLOTS];
};

struct cau_store_writer {
	sqlite3 *database; // borrowed
	sqlite3_stmt *statement[CAU_STORE_STATEMENTS];
	// A rollback of records restores its value from before them.
	struct cau_store_uncounted uncounted;
};

// Compiles every statement, which also finds out whether the tables are as this build expects.
cau_status cau_store_writer_init(struct cau_store_writer *writer, sqlite3 *database,
                                 cau_error *error);
void cau_store_writer_finish(struct cau_store_writer *writer); // zeroed or initialised

// CAU_ALREADY_EXISTS and CAU_NOT_FOUND are the record's own fault; anything else is the disk's.
cau_status cau_store_writer_apply(struct cau_store_writer *writer, const struct record *record,
                                  int64_t now_ms, cau_error *error);

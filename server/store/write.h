// SPDX-License-Identifier: GPL-3.0-or-later
// Writes records into the database, inside a transaction of the caller.
#pragma once

#include <sqlite3.h>

#include "batch.h"

enum {
	CAU_STORE_STATEMENTS = 20,
	// number of slots: about as many as branches that are written at the same time
	CAU_STORE_UNCOUNTED_SLOTS = 16,
};

// Bytes of commands that branches.bytes does not count yet. Counting with each command would write
// the table page of branches with each commit. A crash loses these bytes, less than a page for each
// branch.
struct cau_store_uncounted {
	struct {
		int64_t key, branch, bytes; // bytes 0 means that the slot is free
	} slot[CAU_STORE_UNCOUNTED_SLOTS];
};

struct cau_store_writer {
	sqlite3 *database; // borrowed
	sqlite3_stmt *statement[CAU_STORE_STATEMENTS];
	// A rollback restores the value from before the records that it undoes.
	struct cau_store_uncounted uncounted;
};

// Compiles every statement. This also checks that the tables are as this build expects.
cau_status cau_store_writer_init(struct cau_store_writer *writer, sqlite3 *database,
                                 cau_error *error);
// the writer may be zeroed or initialised
void cau_store_writer_finish(struct cau_store_writer *writer);

// Writes one record. CAU_ALREADY_EXISTS and CAU_NOT_FOUND are the record's own errors; any other
// error is the disk's.
cau_status cau_store_writer_apply(struct cau_store_writer *writer, const struct record *record,
                                  int64_t now_ms, cau_error *error);

// SPDX-License-Identifier: GPL-3.0-or-later
// The database file: the lock on it, its check, its schema, the connections to it, and folding its
// log.
#pragma once

#include <pthread.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "cautery/status.h"

// ---- SQL and its errors -------------------------------------------------------------------------
// Maps SQLite's result codes to the store's status codes.

// Fills *error from the connection's last failure, with `what` was tried and the system's own
// reason.
cau_status cau_store_fault(sqlite3 *database, int code, const char *what, cau_error *error);

// Runs SQL statements that return no results.
cau_status cau_store_execute(sqlite3 *database, const char *sql, const char *what,
                             cau_error *error);

// Reads one integer: the first column of the first row. Returns CAU_NOT_FOUND if there is no row.
cau_status cau_store_integer(sqlite3 *database, const char *sql, int64_t *value, cau_error *error);

// ---- locks --------------------------------------------------------------------------------------
// Allows one process per store, whatever names its file has. There are two locks. The first is on a
// file beside the database, which names the holder and exists before the database does. The second
// is on the database itself, which a hard link, a bind mount or another path reaches as well.

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

// ---- check before opening -----------------------------------------------------------------------
// Checks a file before the store opens it for writing. Changes nothing.

enum cau_store_found {
	CAU_STORE_ABSENT, // no file: a store may be made
	CAU_STORE_OURS,   // a sound store, of this schema version or an older one
};

// Checks the file at `path`. The caller holds the store's lock. If the store has a label, `label`
// (may be NULL) must be equal to it. Errors are those of cau_store_open().
cau_status cau_store_probe(const char *path, const char *label, enum cau_store_found *found,
                           cau_error *error);

// ---- schema -------------------------------------------------------------------------------------
// The SQL that makes the tables, in steps: step i takes schema version i to i + 1. A new store runs
// all steps, an older one those that it lacks. A released step is never changed.

#define CAU_STORE_APPLICATION_ID 0x43617574 // "Caut", SQLite's application_id
#define CAU_STORE_SCHEMA_VERSION 7          // SQLite's user_version

extern const char *const cau_store_schema_steps[CAU_STORE_SCHEMA_VERSION];

// Runs the schema steps that the database lacks, in one transaction. A failure leaves the database
// unchanged.
cau_status cau_store_migrate(sqlite3 *database, cau_error *error);

// ---- files and connections ----------------------------------------------------------------------
// Makes the database file and opens connections to it.

// Makes a new store at `path`, which must not exist. The store is built under another name, synced,
// and then linked to `path`. So a crash leaves either no file or a complete store there.
cau_status cau_store_file_create(const char *path, cau_error *error);

// Opens the connection that writes. It uses WAL and synchronous = FULL, and never folds the log by
// itself.
cau_status cau_store_file_open(const char *path, size_t wal_bytes, sqlite3 **database,
                               cau_error *error);

// cau_store_memory_open opens a connection to a database in memory, which all connections with that
// name share. `bytes_most`: its largest size; 0: SQLite's bound. cau_store_file_open_reader opens a
// connection that only reads.
cau_status cau_store_memory_open(const char *name, int64_t bytes_most, sqlite3 **database,
                                 cau_error *error);
cau_status cau_store_file_open_reader(const char *path, sqlite3 **database, cau_error *error);

// ---- folding ------------------------------------------------------------------------------------
// Folds the write-ahead log into the database file, on a thread and a connection of its own.
// Folding a long log takes many times as long as a commit, and commits must not wait for it.

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

// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the database file and opens connections to it.
#pragma once

#include <sqlite3.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

// Makes a new store at `path`, where nothing is: built under another name, synced, then linked into
// place, so that a crash leaves either nothing or a whole store there.
cau_status cau_store_file_create(const char *path, cau_error *error);

// The connection that writes: WAL, FULL, no folding of the log by itself.
cau_status cau_store_file_open(const char *path, size_t wal_bytes, sqlite3 **database,
                               cau_error *error);

// A connection that only reads.
// A connection to a database in memory; all with one name share it. `bytes_most`: beyond it it is
// full; 0: the library's bound.
cau_status cau_store_memory_open(const char *name, int64_t bytes_most, sqlite3 **database,
                                 cau_error *error);
cau_status cau_store_file_open_reader(const char *path, sqlite3 **database, cau_error *error);

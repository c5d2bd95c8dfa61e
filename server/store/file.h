// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the database file and opens connections to it.
#pragma once

#include <sqlite3.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

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

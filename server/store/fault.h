// SPDX-License-Identifier: GPL-3.0-or-later
// What SQLite's result codes mean to the store.
#pragma once

#include <sqlite3.h>
#include <stdint.h>

#include "cautery/status.h"

// Fills *error from the connection's last failure, naming `what` was tried and the system's own
// reason.
cau_status cau_store_fault(sqlite3 *database, int code, const char *what, cau_error *error);

// Runs statements without results.
cau_status cau_store_execute(sqlite3 *database, const char *sql, const char *what,
                             cau_error *error);

// One integer: the first column of the first row; CAU_NOT_FOUND if there is no row.
cau_status cau_store_integer(sqlite3 *database, const char *sql, int64_t *value, cau_error *error);

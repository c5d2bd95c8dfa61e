// SPDX-License-Identifier: GPL-3.0-or-later
// Maps SQLite's result codes to the store's status codes.
#pragma once

#include <sqlite3.h>
#include <stdint.h>

#include "cautery/status.h"

// Fills *error from the connection's last failure, with `what` was tried and the system's own
// reason.
cau_status cau_store_fault(sqlite3 *database, int code, const char *what, cau_error *error);

// Runs SQL statements that return no results.
cau_status cau_store_execute(sqlite3 *database, const char *sql, const char *what,
                             cau_error *error);

// Reads one integer: the first column of the first row. Returns CAU_NOT_FOUND if there is no row.
cau_status cau_store_integer(sqlite3 *database, const char *sql, int64_t *value, cau_error *error);

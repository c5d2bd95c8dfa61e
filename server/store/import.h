// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the records of sessions that move, inside a transaction of the caller. Moves are rare, so
// the statements are compiled when they are needed.
#pragma once

#include <sqlite3.h>

#include "batch.h"

// Writes one record. CAU_ALREADY_EXISTS, CAU_NOT_FOUND and CAU_BAD_VALUE are the record's own
// errors; any other error is the disk's.
cau_status cau_store_import(sqlite3 *database, const struct record *record, int64_t now_ms,
                            cau_error *error);

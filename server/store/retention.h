// SPDX-License-Identifier: GPL-3.0-or-later
// Removes what may go, a little at a time.
#pragma once

#include <sqlite3.h>

#include "store/store.h"

// One small step in a transaction of its own: at most some hundred rows or one checkpoint. Sets
// *rows to what it removed; 0: nothing may go at present.
cau_status cau_store_retention_step(sqlite3 *database, const cau_store_config *config,
                                    int64_t *rows, cau_error *error);

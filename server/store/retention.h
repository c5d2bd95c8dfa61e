// SPDX-License-Identifier: GPL-3.0-or-later
// Removes what may go, a little at a time.
#pragma once

#include <sqlite3.h>

#include "store/store.h"

// The budget of the whole store, from step to step; zeroed at the start.
struct cau_store_budget {
	cau_store_budget_state state;
	int64_t bytes;   // of the file in use at the last look
	int64_t dropped; // checkpoints, for the budget, so far
};

// One small step in a transaction of its own: at most some hundred rows or one checkpoint. Sets
// *rows to what it removed; 0: nothing may go at present. `budget` is as it was if it fails.
cau_status cau_store_retention_step(sqlite3 *database, const cau_store_config *config,
                                    struct cau_store_budget *budget, int64_t *rows,
                                    cau_error *error);

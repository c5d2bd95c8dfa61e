// SPDX-License-Identifier: GPL-3.0-or-later
// Removes what retention allows, in small steps.
#pragma once

#include <sqlite3.h>

#include "store/store.h"

// The state of the store's budget between two steps; zeroed at the start.
struct cau_store_budget {
	cau_store_budget_state state;
	int64_t bytes;   // bytes of the file in use at the last check
	int64_t dropped; // checkpoints removed for the budget so far
};

// Takes one small step in a transaction of its own: at most some hundred rows of tables, or one
// checkpoint. *rows: the number of removed rows; 0: nothing may be removed at present. On failure
// `budget` is unchanged.
cau_status cau_store_retention_step(sqlite3 *database, const cau_store_config *config,
                                    struct cau_store_budget *budget, int64_t *rows,
                                    cau_error *error);

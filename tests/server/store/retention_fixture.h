// SPDX-License-Identifier: GPL-3.0-or-later
// A store with a session, "knee". The test calls the steps of retention itself, by its own clock.
#pragma once

#include <stdatomic.h>

#include "store/retention.h"
#include "store_fixture.h"

#define RETENTION_HOUR_MS INT64_C(3600000)
#define RETENTION_START_MS INT64_C(1700000000000)
extern _Atomic int64_t retention_clock_ms;

struct removal {
	int64_t rows, steps, most; // most: rows removed in one step
	struct cau_store_budget budget;
};

// opens the store and sets the clock to its start
cau_store *retention_open(struct fixture *fixture);
// Closes the store, takes steps of retention until nothing more may be removed, and opens it again.
cau_store *retention_retire(struct fixture *fixture, cau_store *store, struct removal *removal);

// Logs a command at each tick from `from` on, before `before`.
void retention_log(cau_store *store, int64_t branch, uint64_t from, uint64_t before);
// Adds a checkpoint with a snapshot of 100 kB.
void retention_put_checkpoint(cau_store *store, int64_t branch, uint64_t tick);
cau_status retention_open_branch(cau_store *store, int64_t branch, int64_t parent,
                                 uint64_t fork_tick);

int retention_count_log(cau_store *store,
                        int64_t branch); // fails the test unless the log is complete from the start
// Returns the tick of the newest checkpoint that the branch sees up to `tick`; -1 if there is none.
int64_t retention_newest_checkpoint(cau_store *store, int64_t branch, uint64_t tick);
int retention_count_branches(cau_store *store);
// A visitor of events that counts them in the int `user`.
cau_status retention_count_event(void *user, const cau_store_event *event);

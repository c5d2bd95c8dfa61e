// SPDX-License-Identifier: GPL-3.0-or-later
// A store with a session, "knee", of which retention takes its steps when a test says so, by the
// test's clock.
#pragma once

#include <stdatomic.h>

#include "store/retention.h"
#include "store_fixture.h"

#define RETENTION_HOUR_MS INT64_C(3600000)
#define RETENTION_START_MS INT64_C(1700000000000)
extern _Atomic int64_t retention_clock_ms;

struct removal {
	int64_t rows, steps, most; // most: rows of one step
	struct cau_store_budget budget;
};

cau_store *retention_open(struct fixture *fixture); // the clock is at its start
// Closes the store, takes retention's steps until nothing may go, and opens it again.
cau_store *retention_retire(struct fixture *fixture, cau_store *store, struct removal *removal);

// A command of each tick from `from` on, before `before`.
void retention_log(cau_store *store, int64_t branch, uint64_t from, uint64_t before);
void retention_put_checkpoint(cau_store *store, int64_t branch, uint64_t tick); // 100 kB
cau_status retention_open_branch(cau_store *store, int64_t branch, int64_t parent,
                                 uint64_t fork_tick);

int retention_count_log(cau_store *store,
                        int64_t branch); // whole from the start, or the test fails
// The tick of the newest that the branch sees up to `tick`; -1: none.
int64_t retention_newest_checkpoint(cau_store *store, int64_t branch, uint64_t tick);
int retention_count_branches(cau_store *store);
// A visitor of events, for an int.
cau_status retention_count_event(void *user, const cau_store_event *event);

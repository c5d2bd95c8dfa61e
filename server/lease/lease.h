// SPDX-License-Identifier: GPL-3.0-or-later
// A daemon's hold on its label. The label is taken from etcd before sessions are resumed. A thread
// renews the lease. The daemon gives up the label before etcd would give it to another daemon.
#pragma once

#include <stdbool.h>

#include "cautery/status.h"
#include "lease/logic.h"

typedef struct cau_lease cau_lease;

enum { CAU_LEASE_STORED_BYTES = 2 * CAU_GENERATION_BYTES + 24 };

typedef struct cau_lease_def {
	const char *addresses; // etcd's addresses, separated by commas
	const char *label;
	const char *store; // path of the database; the caller holds its lock
	double ttl_s;
	bool take_label;
	const char *stored; // the text of the last store_generation, or ""
	// Stores the text, and returns when it is on the disk. Called only within cau_lease_take.
	cau_status (*store_generation)(void *user, const char *text, cau_error *error);
	// Called when the label is lost; must not return. May be called on any thread, once or, in the
	// same moment, twice.
	void (*lost)(void *user, const char *reason) __attribute__((noreturn));
	void *user;
} cau_lease_def;

// Takes the label and starts the thread. Waits for etcd, and until another daemon's lease ends: at
// most twice the time to live. Strings are copied. Errors: CAU_BAD_STATE (another store is newer,
// or another daemon holds the label), CAU_IO (no answer of etcd), CAU_CORRUPT (the text in the
// store or in etcd is not a generation), CAU_BAD_VALUE, CAU_NO_MEMORY.
cau_status cau_lease_take(cau_lease **lease, const cau_lease_def *def, cau_error *error);

// Returns the seconds until the lease ends, on a clock that continues while the machine sleeps.
// Does not return if the lease has ended. Any thread may call it; it never waits.
double cau_lease_check(cau_lease *lease);

int64_t cau_lease_generation(const cau_lease *lease);

// Gives the label back, so that another daemon may take it at once. Waits for etcd at most half a
// second. `lease` may be NULL.
void cau_lease_give_back(cau_lease *lease);

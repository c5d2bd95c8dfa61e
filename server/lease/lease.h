// SPDX-License-Identifier: GPL-3.0-or-later
// A daemon's hold on its label: taken of etcd before sessions are brought up, renewed by a thread
// of its own, and over before etcd would give the label to another.
#pragma once

#include <stdbool.h>

#include "cautery/status.h"
#include "lease/logic.h"

typedef struct cau_lease cau_lease;

enum { CAU_LEASE_STORED_BYTES = 2 * CAU_GENERATION_BYTES + 24 };

typedef struct cau_lease_def {
	const char *addresses; // of etcd, separated by commas
	const char *label;
	const char *store; // path of the database, which the caller has locked
	double ttl_s;
	bool take_label;
	const char *stored; // what `store_generation` was given last, or ""
	// Stores the text; returns when it is on the disk. Called in cau_lease_take alone.
	cau_status (*store_generation)(void *user, const char *text, cau_error *error);
	// The label is lost: does not return. On any thread, once or, in the same moment, twice.
	void (*lost)(void *user, const char *reason) __attribute__((noreturn));
	void *user;
} cau_lease_def;

// Takes the label and starts the thread. Waits for etcd, and for the lease of another to end: twice
// the time to live at most. Strings are copied. Errors: CAU_BAD_STATE (another store is newer, or
// the label is held by another), CAU_IO (no answer of etcd), CAU_CORRUPT (what the store or etcd
// says is no generation), CAU_BAD_VALUE, CAU_NO_MEMORY.
cau_status cau_lease_take(cau_lease **lease, const cau_lease_def *def, cau_error *error);

// Seconds that are left, on no clock that stands still while the machine sleeps. Does not return
// where none are. Any thread; waits for nothing.
double cau_lease_check(cau_lease *lease);

int64_t cau_lease_generation(const cau_lease *lease);

// Gives the label back, so that another may take it at once; waits half a second for etcd at most.
// Takes NULL.
void cau_lease_give_back(cau_lease *lease);

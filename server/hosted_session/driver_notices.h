// SPDX-License-Identifier: GPL-3.0-or-later
// What clients learn of drivers and energy, and of motion that was refused: each tool's is counted,
// and reported to its driver once a second.
#pragma once

#include <pthread.h>

#include "hosted_session/identity.h"

// Of one tool.
typedef struct cau_refused_motion {
	char tool[CAU_NAME_BYTES]; // "": the place is free
	int64_t count;
	double told_s;
	uint32_t client;
	uint64_t sequence; // of the newest
	cau_error error;
} cau_refused_motion;

// Any thread, under the lock.
typedef struct cau_hosted_refusals {
	pthread_mutex_t lock;
	uint64_t count; // of all, since the session was made
	cau_refused_motion place[CAU_MAX_TOOLS];
} cau_hosted_refusals;

void cau_refusals_note(cau_hosted_refusals *refusals, const cau_order *order,
                       const cau_error *error);
void cau_refusals_report(cau_hosted_refusals *refusals, const cau_hosted_identity *identity,
                         double now_s); // those that are due

// Sends tool.driver_changed.
void cau_driver_notify(const cau_hosted_identity *identity, const cau_drive *drive);

// SPDX-License-Identifier: GPL-3.0-or-later
// Notifies clients of drivers and energy. Also counts refused motion for each tool and reports the
// count to the client that sent it, once a second.
#pragma once

#include <pthread.h>

#include "hosted_session/identity.h"

// Refused motion of one tool.
typedef struct cau_refused_motion {
	char tool[CAU_NAME_BYTES]; // "": the entry is unused
	int64_t count;
	double told_s;
	uint32_t client;
	uint64_t sequence; // sequence number of the newest refused motion
	cau_error error;
} cau_refused_motion;

// Refused motion of all tools of a session. Any thread may use this struct, under the lock.
typedef struct cau_hosted_refusals {
	pthread_mutex_t lock;
	uint64_t count; // refused motions of all tools since the session was created
	cau_refused_motion place[CAU_MAX_TOOLS];
} cau_hosted_refusals;

void cau_refusals_note(cau_hosted_refusals *refusals, const cau_order *order,
                       const cau_error *error);
void cau_refusals_report(cau_hosted_refusals *refusals, const cau_hosted_identity *identity,
                         double now_s); // reports each tool at most once a second

// Sends tool.driver_changed.
void cau_driver_notify(const cau_hosted_identity *identity, const cau_drive *drive);

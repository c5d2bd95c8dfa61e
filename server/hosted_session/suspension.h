// SPDX-License-Identifier: GPL-3.0-or-later
// A session is suspended while the builder has it: it is built, rewound or moved, no worker runs
// it, and orders wait. The rest belongs to the thread that has the session.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "builder/builder.h"
#include "cautery/session.h"
#include "hosted_session/hosted.h"

typedef struct cau_holding cau_holding;

typedef struct cau_hosted_suspension {
	pthread_mutex_t lock;
	atomic_bool active;    // any thread; it ends under the lock, and the builder alone ends it
	cau_order *cancelling; // lock: session.destroy that came meanwhile

	cau_order *destroyers; // of those the ones that are no resends, in their order
	cau_job *job;          // the builder's, once this slice has ended; NULL: none
	cau_holding *holding;  // it is suspended to be moved; NULL: it is not
	char stage[32];        // what the builder does with it; else ""
} cau_hosted_suspension;

// Lets the builder have a session whose slice has ended, for suspension.job. From here on it is the
// builder's.
void cau_suspension_begin(cau_hosted_suspension *suspension, const cau_surroundings *around);
// From here on it is the workers', and a session.destroy waits in the queue. Returns those that
// came before.
cau_order *cau_suspension_end(cau_hosted_suspension *suspension);
// Takes the order if it destroys a session that is suspended. Any thread.
bool cau_suspension_cancel(cau_hosted_suspension *suspension, const char *id, cau_order *order);
// Whether a client destroys it: suspension.destroyers.
bool cau_suspension_is_cancelled(cau_hosted *h);
// CAU_BAD_STATE, where the session is destroyed or the daemon ends. `doing`: "was being built".
cau_status cau_suspension_check(cau_hosted *h, const char *doing, const char *next,
                                cau_error *error);
void cau_suspension_name_stage(cau_hosted_suspension *suspension, const char *stage);
// Between two stages of building; `user` is the session.
cau_status cau_building_border(void *user, const cau_build_border *border, cau_error *error);

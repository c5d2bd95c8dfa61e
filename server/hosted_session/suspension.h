// SPDX-License-Identifier: GPL-3.0-or-later
// A session is suspended while the builder has it, to build, rewind or move it. No worker runs the
// session then, and its orders wait. The members without a note are for the session's owning thread
// (internal.h).
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "builder/builder.h"
#include "cautery/session.h"
#include "hosted_session/hosted.h"

typedef struct cau_holding cau_holding;

typedef struct cau_hosted_suspension {
	pthread_mutex_t lock;
	atomic_bool active;    // any thread; only the builder clears it, under the lock
	cau_order *cancelling; // under the lock: session.destroy orders that came during the suspension

	cau_order *destroyers; // the orders of `cancelling` that are no resends, in their order
	cau_job *job;          // job for the builder after this slice; NULL: none
	cau_holding *holding;  // the suspension for a move; NULL: none
	char stage[32];        // present stage of the builder's work; "": none
} cau_hosted_suspension;

// Suspends a session whose slice has ended, and submits suspension.job to the builder. From here on
// only the builder uses the session.
void cau_suspension_begin(cau_hosted_suspension *suspension, const cau_surroundings *around);
// Returns the session to the workers. From here on session.destroy waits in the queue. Returns the
// session.destroy orders that came before.
cau_order *cau_suspension_end(cau_hosted_suspension *suspension);
// Takes the order if it is a session.destroy of a suspended session. Any thread may call this.
bool cau_suspension_cancel(cau_hosted_suspension *suspension, const char *id, cau_order *order);
// True if a client destroys the session: suspension.destroyers is not empty.
bool cau_suspension_is_cancelled(cau_hosted *h);
// Returns CAU_BAD_STATE if the session is destroyed or the daemon ends. The error's text uses
// `doing`, for example "was being built", and `next`, the next stage.
cau_status cau_suspension_check(cau_hosted *h, const char *doing, const char *next,
                                cau_error *error);
void cau_suspension_name_stage(cau_hosted_suspension *suspension, const char *stage);
// Called between two stages of building; `user` is the session.
cau_status cau_building_border(void *user, const cau_build_border *border, cau_error *error);

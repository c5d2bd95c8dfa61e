// SPDX-License-Identifier: GPL-3.0-or-later
// How a session is created, and how it ends.
#pragma once

#include <stdatomic.h>

#include "hosted_session/hosted.h"

// The creation of a session. Until the session is started, only the builder uses this struct. Any
// thread may use the members marked "any thread".
typedef struct cau_hosted_creation {
	cau_hosted_origin origin;
	bool pause_at_start;
	bool incoming; // the session arrives by a move and is not accepted yet: it is built, then waits
	bool came;     // the session arrived by a move and was accepted
	bool unwanted; // the creation was cancelled
	bool replaying; // workers replay the log, after a restart or a fork
	// the job that built an arriving session, while it waits to be accepted; else NULL
	cau_job *job;
	cau_reply reply;        // reply to the creator; read through cau_hosted_take_creator
	atomic_bool waits;      // any thread: `reply` is not answered yet
	atomic_bool abandoned;  // any thread: the creator is disconnected
	atomic_bool starting;   // any thread: the session is not served yet
	atomic_bool unanswered; // any thread: the first rows are not handed to the store yet
	int64_t memory_held;    // share of the memory that all sessions may take, bytes
} cau_hosted_creation;

// The end of a session. Any thread may read this struct.
typedef struct cau_hosted_life {
	atomic_bool ended, drain_wanted, drained;
	// target of the move after which the session ended here; written before `ended`
	cau_moved_to moved;
} cau_hosted_life;

// ---- hosted.c
// Refuses an order because the session has ended.
void cau_hosted_refuse_gone(const cau_hosted_life *life, cau_order *order);
// Ends a session that could not be built or kept. It accepts no more orders. Any thread may call
// this.
void cau_hosted_end(cau_hosted *h);
// Copies the reply to the session's creator on the first call, and the caller answers it. Later
// calls return false. Any thread may call this.
bool cau_hosted_take_creator(cau_hosted_creation *creation, cau_reply *reply);
// Answers the session's creator with an error, unless the reply was already taken. Any thread may
// call this.
void cau_hosted_fail_creator(cau_hosted_creation *creation, const cau_error *error, int32_t code);

// ---- build_job.c
// Hands a new session to the builder.
cau_status cau_building_begin(cau_hosted *h, cau_error *error);
// Ends the builder's last slice of a suspended session. The session returns to the workers, or has
// ended.
void cau_building_over(cau_hosted *h);

// ---- start.c: builds the core and loads the state, on the builder
void cau_hosted_start(cau_hosted *h);
void cau_hosted_fail_start(cau_hosted *h, const cau_error *error);
void cau_hosted_started(cau_hosted *h); // called after the replay of a start
// Starts a session whose core is built, from the rows that the store has now.
void cau_hosted_resume(cau_hosted *h);

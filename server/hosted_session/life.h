// SPDX-License-Identifier: GPL-3.0-or-later
// How a session comes to be, and how it ends.
#pragma once

#include <stdatomic.h>

#include "hosted_session/hosted.h"

// Until the session is started it belongs to the builder. What is marked may be read or set by any
// thread.
typedef struct cau_hosted_creation {
	cau_hosted_origin origin;
	bool pause_at_start;
	bool incoming;          // of a move, and not accepted yet: it is built and then waits for that
	bool came;              // and has been accepted since
	bool unwanted;          // it was cancelled
	bool replaying;         // after a restart or a fork, on the workers
	cau_job *job;           // that built it, while it waits to be accepted; else NULL
	cau_reply reply;        // to its creator; read by cau_hosted_take_creator
	atomic_bool waits;      // any thread: the reply is to be answered
	atomic_bool abandoned;  // any thread: its creator is gone
	atomic_bool starting;   // any thread: it is not served yet
	atomic_bool unanswered; // any thread: its making is not with the store yet
	int64_t memory_held;    // of what all sessions may take
} cau_hosted_creation;

// Any thread reads it.
typedef struct cau_hosted_life {
	atomic_bool ended, drain_wanted, drained;
	cau_moved_to moved; // once it has ended: where it went; written before `ended`
} cau_hosted_life;

// ---- hosted.c
// There is no session for the order any more.
void cau_hosted_refuse_gone(const cau_hosted_life *life, cau_order *order);
// It could not be brought up or kept: nothing is taken any more. Any thread.
void cau_hosted_end(cau_hosted *h);
// Hands out the reply to the session's creator, once: the caller answers it. False after the first
// call. Any thread.
bool cau_hosted_take_creator(cau_hosted_creation *creation, cau_reply *reply);
// Answers the session's creator with an error. Does nothing if the reply was taken before. Any
// thread.
void cau_hosted_fail_creator(cau_hosted_creation *creation, const cau_error *error, int32_t code);

// ---- build_job.c
// Leaves a session that was just made to the builder.
cau_status cau_building_begin(cau_hosted *h, cau_error *error);
// The builder's last slice of a session that was suspended: it is the workers' again, or has ended.
void cau_building_over(cau_hosted *h);

// ---- start.c: builds the core, loads the state; on the builder
void cau_hosted_start(cau_hosted *h);
void cau_hosted_fail_start(cau_hosted *h, const cau_error *error);
void cau_hosted_started(cau_hosted *h); // after the replay of a start
// Brings a session up whose core is built, from what the store has now.
void cau_hosted_resume(cau_hosted *h);

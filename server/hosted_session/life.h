// SPDX-License-Identifier: GPL-3.0-or-later
// A session from its creation to its end: the values that never change, its core, how the builder
// builds and suspends it within limits, and how it ends.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "builder/builder.h"
#include "cautery/session.h"
#include "hosted_session/hosted.h"

// ---- what never changes -------------------------------------------------------------------------
// The values of a session that never change after its creation. Any thread reads them without a
// lock.

typedef struct cau_hosted_identity {
	char id[CAU_NAME_BYTES];
	uint32_t number;
	const cau_surroundings *around; // outlives the session
	cau_scene_def *scene;           // as it was at creation; owned
	void *meshes;                   // source bytes of the scene's meshes; owned
	size_t mesh_bytes;
	cau_asker creator;
	int64_t creator_sequence; // 0: no sequence number
} cau_hosted_identity;

// ---- the core -----------------------------------------------------------------------------------
// The core with the session's present state. Only the session's owning thread uses it: the worker
// of the slice, or the builder while the session is suspended.

typedef struct cau_present_core {
	cau_session *session; // NULL until the core is built
	// description of a built core; it never changes, so any thread may read it
	cau_session_info info;
	cau_scene_def *described; // memory for a description of the present state
	uint64_t tick;
	bool adopted; // the core's threads have the priority of workers
} cau_present_core;

// ---- creation and end ---------------------------------------------------------------------------

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

// ---- suspension ---------------------------------------------------------------------------------
// A session is suspended while the builder has it, to build, rewind or move it. No worker runs the
// session then, and its orders wait. The members without a note are for the session's owning thread
// (internal.h).

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

// ---- limits on builds ---------------------------------------------------------------------------
// The time and memory that a session, or a second core of it, needs to be built, and the limits on
// them. `held` is the caller's current share, in bytes, of the memory that all sessions may take. A
// new amount replaces the old share.

// Returns the estimated time to build the scene, s.
double cau_building_expects_s(const cau_scene_def *scene);
// Sets the share *held to `bytes`. Returns CAU_LIMIT if all sessions together would exceed
// max_sessions_bytes. `holder` is the subject of the error's reason.
cau_status cau_building_hold(const cau_surroundings *around, int64_t *held, int64_t bytes,
                             const char *holder, cau_error *error);
void cau_building_release(const cau_surroundings *around, int64_t *held);
// Sets a session's share *held to `bytes`. A single session must also stay below max_session_bytes.
cau_status cau_building_hold_session(const cau_surroundings *around, int64_t *held, int64_t bytes,
                                     cau_error *error);
// Called between two stages of building. Checks the vertex and element counts, then sets the share
// *held to the memory that the session will take. Returns CAU_LIMIT if a limit is exceeded.
cau_status cau_building_check_limits(const cau_surroundings *around, int64_t *held,
                                     const cau_build_border *border, cau_error *error);

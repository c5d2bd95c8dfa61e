// SPDX-License-Identifier: GPL-3.0-or-later
// session.frame_at: views of past ticks of one session. A second core of the session computes them
// on the builder. The requests of clients wait in a queue.
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "buffer/buffer.h"
#include "hosted_session/record.h"
#include "stream/stream.h"

// ---- kept states (past_core.c) ------------------------------------------------------------------
// Snapshots of states that past views have passed, in memory and within a budget of bytes. The next
// view can start from such a state instead of an earlier checkpoint of the store. All states belong
// to the line of one branch.

enum { CAU_KEPT_STATES_MOST = 256 };

typedef struct cau_kept_state {
	uint64_t tick;
	bool exact; // from cau_session_restore: the state is exact
	void *bytes;
	size_t byte_count;
} cau_kept_state;

// A zeroed struct is empty.
typedef struct cau_kept_states {
	int64_t branch;
	int32_t count;
	size_t byte_count;                          // bytes of all snapshots
	cau_kept_state state[CAU_KEPT_STATES_MOST]; // in ascending order of ticks
} cau_kept_states;

// Adds a state and takes ownership of its malloc'ed bytes. The new state replaces a state of the
// same tick. Beyond `budget`, states are dropped whose neighbours are closest to each other. States
// of another branch are dropped first.
void cau_kept_states_put(cau_kept_states *kept, size_t budget, int64_t branch,
                         const cau_kept_state *state);
// Returns the newest state at or before the tick, or NULL.
const cau_kept_state *cau_kept_states_find(const cau_kept_states *kept, int64_t branch,
                                           uint64_t tick);
void cau_kept_states_finish(cau_kept_states *kept);

// ---- the second core ----------------------------------------------------------------------------
// A second core of a session. The second core goes to past ticks of the session and makes frames of
// them. It changes nothing that the session's steps change. One thread at a time uses it, in the
// same stages as a rewind (rewind.c).

typedef struct cau_past_core {
	const cau_hosted_identity *identity; // borrowed, as is `commits`
	const cau_hosted_commits *commits;
	cau_session *session; // NULL: not built
	int64_t memory_held;  // share of the memory that all sessions may take, bytes
	bool somewhere;       // the core has a state: that of replay.tick on the line of `branch`
	bool arrived;         // the core already has a state from which the replay can continue
	int64_t branch;
	cau_replay replay;
	cau_kept_states kept;
} cau_past_core;

// Called between the stages of building. Any result except CAU_OK ends the building.
typedef cau_status cau_past_core_border(void *user, cau_error *error);

// Builds the core. Errors: those of cau_session_create; CAU_LIMIT (max_sessions_bytes); those of
// `go_on`.
cau_status cau_past_core_build(cau_past_core *past, cau_past_core_border *go_on, void *user,
                               cau_error *error);
// Reads the log up to a tick of the branch's line. The replay starts from the nearest of the core's
// own state, a kept state and a checkpoint.
cau_status cau_past_core_read(cau_past_core *past, int64_t branch, uint64_t tick, cau_error *error);
// Brings the core to the state where the replay starts.
cau_status cau_past_core_restore(cau_past_core *past, cau_error *error);
// Replays for about `seconds`. *over: the tick is reached.
cau_status cau_past_core_slice(cau_past_core *past, double seconds, bool *over, cau_error *error);
// Returns a key frame of the core's state with a reference for the caller, or NULL and the error.
cau_buffer *cau_past_core_frame(cau_past_core *past, const cau_stream_def *def, uint64_t epoch,
                                cau_error *error);
void cau_past_core_finish(cau_past_core *past);

// ---- views --------------------------------------------------------------------------------------

typedef struct cau_past_views {
	cau_job job; // must be the first member
	cau_hosted *hosted;

	pthread_mutex_t lock; // guards the next six members
	cau_order *waiting;
	cau_order *present; // the request that the core serves; NULL: none
	bool busy;          // the builder has the core
	bool given_up;      // the client cancelled the request in `present`
	bool tired;         // the core must be freed
	double idle_since_s;

	cau_past_core core; // only for the builder while `busy`, as is `stage`
	cau_look_stage stage;
} cau_past_views;

void cau_past_views_init(cau_past_views *views, cau_hosted *hosted);
// Drops the requests of a client. Any thread may call this.
void cau_past_views_give_up(cau_past_views *views, uint32_t client);
// Returns the time at which an unused core must be freed; INFINITY: no time is set.
double cau_past_views_due_s(cau_past_views *views);
// Lets the builder free the core if its time has come.
void cau_past_views_tire(cau_past_views *views, double now_s);

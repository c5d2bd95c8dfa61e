// SPDX-License-Identifier: GPL-3.0-or-later
// A second core of a session. The second core goes to past ticks of the session and makes frames of
// them. It changes nothing that the session's steps change. One thread at a time uses it, in the
// same stages as a rewind (rewind.c).
#pragma once

#include "buffer/buffer.h"
#include "hosted_session/kept_states.h"
#include "hosted_session/replay.h"
#include "stream/stream.h"

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

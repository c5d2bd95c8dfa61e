// SPDX-License-Identifier: GPL-3.0-or-later
// A second core of a session, which goes to ticks of its past and shows them. It touches nothing
// that the session's steps change: of the session it reads its scene, its id and its surroundings,
// which stay for its life. By one thread at a time, in stages, as a session goes back (back.c).
#pragma once

#include "hosted_session/internal.h"
#include "hosted_session/kept_states.h"

typedef struct cau_past {
	cau_hosted *hosted;  // borrowed
	cau_session *core;   // NULL: not built
	int64_t memory_held; // of what all sessions may take
	bool somewhere;      // the core is at a state: replay.tick on the line of `branch`
	bool arrived;        // what the replay wants needs no restoring
	int64_t branch;
	cau_replay replay;
	cau_kept_states kept;
} cau_past;

// Asked between the stages of building; anything but CAU_OK ends it.
typedef cau_status cau_past_go_on(void *user, cau_error *error);

// Errors: those of cau_session_create; CAU_LIMIT (max_sessions_bytes); what `go_on` says.
cau_status cau_past_build(cau_past *past, cau_past_go_on *go_on, void *user, cau_error *error);
// Reads the way to a tick of the branch's line, from where the core is, a state that was kept, or a
// checkpoint, whichever is nearest.
cau_status cau_past_read(cau_past *past, int64_t branch, uint64_t tick, cau_error *error);
// Has the core be where that way begins.
cau_status cau_past_restore(cau_past *past, cau_error *error);
// Follows it for some seconds.
cau_status cau_past_slice(cau_past *past, double seconds, bool *over, cau_error *error);
// The key frame of where the core is, for the caller; NULL with the error.
cau_buffer *cau_past_frame(cau_past *past, const cau_stream_def *def, uint64_t epoch,
                           cau_error *error);
void cau_past_finish(cau_past *past);

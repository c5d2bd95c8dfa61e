// SPDX-License-Identifier: GPL-3.0-or-later
// A second core of a session, which goes to ticks of its past and shows them. It touches nothing
// that the session's steps change. By one thread at a time, in stages, as a session is rewound
// (rewind.c).
#pragma once

#include "buffer/buffer.h"
#include "hosted_session/kept_states.h"
#include "hosted_session/replay.h"
#include "stream/stream.h"

typedef struct cau_past_core {
	const cau_hosted_identity *identity; // borrowed, like the commits
	const cau_hosted_commits *commits;
	cau_session *session; // NULL: not built
	int64_t memory_held;  // of what all sessions may take
	bool somewhere;       // the core is at a state: replay.tick on the line of `branch`
	bool arrived;         // what the replay wants needs no restoring
	int64_t branch;
	cau_replay replay;
	cau_kept_states kept;
} cau_past_core;

// Asked between the stages of building; anything but CAU_OK ends it.
typedef cau_status cau_past_core_border(void *user, cau_error *error);

// Errors: those of cau_session_create; CAU_LIMIT (max_sessions_bytes); what `go_on` says.
cau_status cau_past_core_build(cau_past_core *past, cau_past_core_border *go_on, void *user,
                               cau_error *error);
// Reads the way to a tick of the branch's line, from where the core is, a state that was kept, or a
// checkpoint, whichever is nearest.
cau_status cau_past_core_read(cau_past_core *past, int64_t branch, uint64_t tick, cau_error *error);
// Has the core be where that way begins.
cau_status cau_past_core_restore(cau_past_core *past, cau_error *error);
// Follows it for some seconds.
cau_status cau_past_core_slice(cau_past_core *past, double seconds, bool *over, cau_error *error);
// The key frame of where the core is, for the caller; NULL with the error.
cau_buffer *cau_past_core_frame(cau_past_core *past, const cau_stream_def *def, uint64_t epoch,
                                cau_error *error);
void cau_past_core_finish(cau_past_core *past);

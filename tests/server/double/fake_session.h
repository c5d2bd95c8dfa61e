// SPDX-License-Identifier: GPL-3.0-or-later
// What a test sees and holds up of the double of the core. Set before the first session is made,
// and left alone until the last is gone; called on the thread that calls the core.
#pragma once

#include "cautery/session.h"

typedef struct cau_fake_hooks {
	// The creation comes to the border before this stage; CAU_BUILD_STAGE_COUNT: it has ended.
	void (*build)(cau_build_stage next);
	// New sessions say that they have built-in tension.
	bool tension;
	uint64_t tissue_hash; // theirs
	// A snapshot is about to be restored; what is not CAU_OK fails it, half restored.
	cau_status (*restore)(void);
	// The core is about to take this command.
	void (*submit)(const cau_command *command);
	// A tick is being computed; the commands that were due are in the tools.
	void (*step)(const cau_session *session);
	// Energy is about to be turned off; true: the double is broken, and leaves it on.
	bool (*breaks_off)(void);
	// A session was made, is about to take a command, is about to go.
	void (*made)(const cau_session_def *def, const cau_session *session);
	void (*taking)(const cau_session *session, const cau_command *command);
	void (*going)(const cau_session *session);
} cau_fake_hooks;

extern cau_fake_hooks cau_fake_hooks_set;

// What gravity.set last set, once what is queued has acted; m/s^2, borrowed.
const double *cau_fake_gravity(const cau_session *session);

// SPDX-License-Identifier: GPL-3.0-or-later
// Hooks by which a test observes and stops the double of the core. Set them before the first
// session is created, and do not change them until the last session is destroyed. The hooks run on
// the thread that calls the core.
#pragma once

#include "cautery/session.h"

typedef struct cau_fake_hooks {
	// Called when the creation reaches the border before this stage; CAU_BUILD_STAGE_COUNT: its
	// end.
	void (*build)(cau_build_stage next);
	// True if new sessions report built-in tension.
	bool tension;
	uint64_t tissue_hash; // tissue hash of new sessions
	// Called before a snapshot is restored. Any result except CAU_OK fails the restore halfway.
	cau_status (*restore)(void);
	// Called before the core takes this command.
	void (*submit)(const cau_command *command);
	// Called while a tick is computed. The tools already have the effect of the commands that were
	// due.
	void (*step)(const cau_session *session);
	// Called before energy is turned off. If it returns true, the double leaves energy on.
	bool (*breaks_off)(void);
	// Called after a session was created, before it takes a command, and before it is destroyed.
	void (*made)(const cau_session_def *def, const cau_session *session);
	void (*taking)(const cau_session *session, const cau_command *command);
	void (*going)(const cau_session *session);
} cau_fake_hooks;

extern cau_fake_hooks cau_fake_hooks_set;

// Returns the gravity after all queued commands, m/s^2; borrowed.
const double *cau_fake_gravity(const cau_session *session);

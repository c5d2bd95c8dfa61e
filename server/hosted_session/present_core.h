// SPDX-License-Identifier: GPL-3.0-or-later
// The core at the session's present tick. It belongs to the thread that has the session: the worker
// of its slice, or the builder while the session is suspended (suspension.h).
#pragma once

#include "cautery/session.h"

typedef struct cau_present_core {
	cau_session *session;     // NULL until it is built
	cau_session_info info;    // of one that is built; it never changes, so any thread may read it
	cau_scene_def *described; // memory for a description of the present
	uint64_t tick;
	bool adopted; // its threads have the workers' priority
} cau_present_core;

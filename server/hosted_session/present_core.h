// SPDX-License-Identifier: GPL-3.0-or-later
// The core with the session's present state. Only the session's owning thread uses it: the worker
// of the slice, or the builder while the session is suspended (suspension.h).
#pragma once

#include "cautery/session.h"

typedef struct cau_present_core {
	cau_session *session; // NULL until the core is built
	// description of a built core; it never changes, so any thread may read it
	cau_session_info info;
	cau_scene_def *described; // memory for a description of the present state
	uint64_t tick;
	bool adopted; // the core's threads have the priority of workers
} cau_present_core;

// SPDX-License-Identifier: GPL-3.0-or-later
// Looks at the past of one session: the one core that goes there, and who waits for it.
#pragma once

#include "hosted_session/past.h"

struct cau_looks {
	cau_job job; // first
	cau_hosted *hosted;

	// guarded by the session's mutex
	cau_order *waiting;
	cau_order *present; // what the core is after; NULL: nothing
	bool busy;          // with the builder
	bool given_up;      // the present one
	bool tired;         // the core is to go
	double idle_since_s;

	// the builder's while busy
	cau_past past;
	cau_look_stage stage;
};

// When its core is to go; INFINITY: never, as things are. Under the session's mutex; NULL is fine.
double cau_looks_tires_s(const cau_looks *looks);

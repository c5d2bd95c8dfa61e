// SPDX-License-Identifier: GPL-3.0-or-later
// A session and its parts. Each part has an owner, which its header names: a lock, a thread, or the
// session's owning thread. The owning thread is the worker that runs the session's slice. While the
// session is suspended, the owning thread is the builder's.
#pragma once

#include "clock/clock.h"
#include "hosted_session/decisions.h"
#include "hosted_session/life.h"
#include "hosted_session/past_views.h"
#include "hosted_session/published.h"
#include "hosted_session/read_requests.h"
#include "hosted_session/timeline.h"
#include "trace/trace.h"

struct cau_hosted {
	cau_task task; // must be the first member
	atomic_int references;
	cau_hosted_identity identity; // never changes

	// only for the owning thread
	cau_present_core core;
	cau_hosted_history history;
	cau_hosted_timeline timeline;
	cau_hosted_findings findings;
	cau_hosted_pace pace;
	cau_hosted_record record;
	cau_replay replay;

	// only for the owning thread, except members that are atomic or have their own lock
	cau_hosted_creation creation;
	cau_hosted_suspension suspension;
	cau_hosted_frames frames;

	// each has a lock
	cau_hosted_decisions decisions;
	cau_hosted_published published;
	cau_hosted_refusals refusals;
	cau_hosted_reads reads;
	cau_past_views past;

	// all members are atomic
	cau_hosted_commits commits;
	cau_hosted_life life;
};

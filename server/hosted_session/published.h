// SPDX-License-Identifier: GPL-3.0-or-later
// The values of a session that other threads may read. The session's owning thread (internal.h)
// publishes them. The lock guards all of them and is held briefly.
#pragma once

#include <pthread.h>

#include "cautery/session.h"
#include "hosted_session/hosted.h"

typedef struct cau_hosted_published {
	pthread_mutex_t lock;
	cau_wire_session_summary summary;
	cau_hosted_counts counts;
	cau_tool_state tools[CAU_MAX_TOOLS]; // of the newest tick; transports read them
	int32_t tool_count;
	uint64_t tick; // tick of `tools`
	double time_s;
} cau_hosted_published;

// Publishes the session's present state for other threads. Only the owning thread calls this.
void cau_hosted_publish_summary(cau_hosted *h);
void cau_hosted_publish_tools(cau_hosted *h);
// Adds *more to the counts. After a step, the members that describe one step are replaced.
void cau_published_count(cau_hosted_published *published, const cau_hosted_counts *more);

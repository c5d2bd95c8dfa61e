// SPDX-License-Identifier: GPL-3.0-or-later
// What other threads see of a session, as its thread published it last. All of it is guarded by the
// lock, which is held for moments.
#pragma once

#include <pthread.h>

#include "cautery/session.h"
#include "hosted_session/hosted.h"

typedef struct cau_hosted_published {
	pthread_mutex_t lock;
	cau_wire_session_summary summary;
	cau_hosted_counts counts;
	cau_tool_state tools[CAU_MAX_TOOLS]; // of the newest tick, for transports
	int32_t tool_count;
	uint64_t tick; // of the tools
	double time_s;
} cau_hosted_published;

// By the thread that has the session. From here on the other threads see its state of now.
void cau_hosted_publish_summary(cau_hosted *h);
void cau_hosted_publish_tools(cau_hosted *h);
// Adds these; of a step the rest is as it was in the last one.
void cau_published_count(cau_hosted_published *published, const cau_hosted_counts *more);

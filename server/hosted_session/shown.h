// SPDX-License-Identifier: GPL-3.0-or-later
// The frame, tools and statistics of one tick of a core, in the form that streams send.
#pragma once

#include "cautery/session.h"
#include "stream/stream.h"

// `sample` points into the other members, and into the core.
typedef struct cau_shown {
	cau_frame frame;
	cau_stream_tool tools[CAU_MAX_TOOLS]; // without their drivers
	cau_stream_statistics statistics;
	cau_stream_sample sample;
} cau_shown;
void cau_show(const cau_session *core, cau_shown *shown);

// SPDX-License-Identifier: GPL-3.0-or-later
// The frame, tools and statistics of a core's tick, as streams carry them.
#pragma once

#include "cautery/session.h"
#include "stream/stream.h"

// The sample points into the rest, and into the core.
typedef struct cau_shown {
	cau_frame frame;
	cau_stream_tool tools[CAU_MAX_TOOLS]; // without drivers
	cau_stream_statistics statistics;
	cau_stream_sample sample;
} cau_shown;
void cau_show(const cau_session *core, cau_shown *shown);

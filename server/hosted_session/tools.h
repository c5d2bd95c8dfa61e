// SPDX-License-Identifier: GPL-3.0-or-later
// A session's tools, for transports that drive tools without JSON-RPC messages.
#pragma once

#include "cautery/session.h"
#include "hosted_session/hosted.h"

typedef struct cau_hosted_tool {
	cau_tool_state state; // of the newest tick
	cau_asker driver;     // client 0: no driver
	bool energized;       // the core's own flag at the end of the last slice
	int energy_off;       // CAU_ENERGY_OFF_*
} cau_hosted_tool;

// Copies the tools into `tools`, at most CAU_MAX_TOOLS, and returns their number; 0 while the
// session starts. *tick and *time_s (simulated, s) are those of the tools. Any thread may call
// this.
int32_t cau_hosted_tools(cau_hosted *hosted, cau_hosted_tool *tools, uint64_t *tick,
                         double *time_s);
// Copies one tool. Returns false if no tool has this name.
bool cau_hosted_find_tool(cau_hosted *hosted, const char *name, cau_hosted_tool *tool);
// Notes a sign of life like cau_hosted_feed, for one tool ("": for all tools of the client).
void cau_hosted_feed_tool(cau_hosted *hosted, uint32_t client, const char *tool, double alive_s);
// Counts motion that a transport refused before it became an order.
void cau_hosted_refuse(cau_hosted *hosted, const char *tool, const cau_asker *asker,
                       uint64_t sequence, const cau_error *error);
// Counts motion that a transport dropped unread, because it named no tool or no known client.
void cau_hosted_count_refused(cau_hosted *hosted, uint64_t count);

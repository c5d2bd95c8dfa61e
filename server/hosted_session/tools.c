// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/tools.h"

#include <string.h>

#include "hosted_session/internal.h"

void cau_hosted_publish_tools(cau_hosted *h)
{
	cau_frame frame;
	if (!h->core || h->starting || h->ended)
		return;
	cau_session_frame(h->core, &frame);
	pthread_mutex_lock(&h->mutex);
	h->tool_count = frame.tool_count;
	memcpy(h->tools, frame.tools, (size_t)frame.tool_count * sizeof *h->tools);
	h->tools_tick = frame.tick;
	h->tools_time_s = frame.time_s;
	pthread_mutex_unlock(&h->mutex);
}

static void copy_tool(cau_hosted *h, const cau_tool_state *state, cau_hosted_tool *tool)
{
	*tool = (cau_hosted_tool){
		.state = *state, .energized = state->energized, .energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
	cau_drive drive;
	if (!cau_decide_find(h, state->name, &drive))
		return;
	tool->driver = drive.driver;
	tool->energy_off = drive.energy_off;
}

int32_t cau_hosted_tools(cau_hosted *h, cau_hosted_tool *tools, uint64_t *tick, double *time_s)
{
	cau_tool_state states[CAU_MAX_TOOLS];
	pthread_mutex_lock(&h->mutex);
	int32_t count = h->tool_count;
	memcpy(states, h->tools, (size_t)count * sizeof *states);
	*tick = h->tools_tick;
	*time_s = h->tools_time_s;
	pthread_mutex_unlock(&h->mutex);
	for (int32_t i = 0; i < count; i++)
		copy_tool(h, &states[i], &tools[i]);
	return count;
}

bool cau_hosted_find_tool(cau_hosted *h, const char *name, cau_hosted_tool *tool)
{
	cau_tool_state state;
	bool found = false;
	pthread_mutex_lock(&h->mutex);
	for (int32_t i = 0; i < h->tool_count && !found; i++)
		if (strcmp(h->tools[i].name, name) == 0) {
			state = h->tools[i];
			found = true;
		}
	pthread_mutex_unlock(&h->mutex);
	if (found)
		copy_tool(h, &state, tool);
	return found;
}

void cau_hosted_refuse(cau_hosted *h, const char *tool, const cau_asker *asker, uint64_t sequence,
                       const cau_error *error)
{
	cau_order order = {.motion = true, .asker = *asker};
	snprintf(order.as.command.tool, sizeof order.as.command.tool, "%s", tool);
	order.as.command.sequence = sequence;
	cau_drive_refuse(h, &order, error);
}

void cau_hosted_count_refused(cau_hosted *h, uint64_t count)
{
	pthread_mutex_lock(&h->mutex);
	h->counts.refused += count;
	pthread_mutex_unlock(&h->mutex);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Energy off and hold: calls that cannot fail and need no capacity in the queue. They act at once,
// not at the next tick. Commands that wait for a later tick must not undo them, so these are
// removed from the queue. An energy-off removes enables. A hold, or the removal of the tool,
// removes every command about the tool.
//
// cau_session_submit does the same for such a command that is due. So a log that contains the
// command replays with the same bits.
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// ---- waiting commands

static bool is_about(const cau_command *command, const char *tool)
{
	bool about_tool =
		(command->kind > CAU_COMMAND_TOOL_ADD && command->kind <= CAU_COMMAND_TOOL_RELEASE) ||
		command->kind == CAU_COMMAND_TOOL_HOLD;
	return about_tool && strcmp(command->tool, tool) == 0;
}

// Whether a command is the automatic end of an enable with `ticks`. It waits in the enable's queue
// slot.
static bool is_limit(const cau_command *command)
{
	return command->kind == CAU_COMMAND_TOOL_ENERGIZE && !command->as.energized &&
	       command->as.ticks > 0;
}

static bool is_enable(const cau_command *command)
{
	return command->kind == CAU_COMMAND_TOOL_ENERGIZE && command->as.energized;
}

static bool is_void(const cau_command *command, const char *tool, cau_void which)
{
	if (!is_about(command, tool))
		return false;
	return which == CAU_VOID_ALL || is_limit(command) ||
	       (which == CAU_VOID_ENABLES && is_enable(command));
}

int32_t cau_session_void(cau_command *queue, int32_t count, const char *tool, cau_void which)
{
	CAU_ASSERT(count >= 0, "a queue of %d commands", count);
	int32_t kept = 0;
	for (int32_t k = 0; k < count; k++)
		if (!is_void(&queue[k], tool, which))
			queue[kept++] = queue[k];
	return kept;
}

int32_t cau_session_waiting(const cau_session *session, const char *tool)
{
	int32_t count = 0;
	for (int32_t k = 0; k < session->queue.count; k++)
		count += is_about(&session->queue.command[k], tool);
	return count;
}

bool cau_session_limit_energy(const cau_command *enable, uint64_t tick, cau_command *end)
{
	if (!is_enable(enable) || enable->as.ticks <= 0)
		return false;
	*end = *enable;
	end->tick = tick + (uint64_t)enable->as.ticks;
	end->sequence = 0;
	end->as.energized = 0;
	return true;
}

// ---- calls that cannot fail

static void disturb(cau_session *session)
{
	session->rest.resting = false;
	session->rest.quiet_ticks = 0;
}

static void take_out(cau_session *session, const char *tool, cau_void which)
{
	session->queue.count =
		cau_session_void(session->queue.command, session->queue.count, tool, which);
}

void cau_session_energy_off(cau_session *session, const char *tool, uint64_t sequence)
{
	int32_t index = cau_session_find_tool(session, tool);
	take_out(session, tool, CAU_VOID_ENABLES);
	if (index < 0)
		return;
	cau_tool_state *state = &session->tool[index].state;
	if (state->energized)
		disturb(session);
	state->energized = false;
	if (sequence)
		state->sequence = sequence;
}

void cau_session_stay(cau_tool *tool)
{
	tool->target = tool->state.pose;
	if (!tool->state.grasping)
		tool->jaw_target = tool->state.jaw;
}

bool cau_session_stays(const cau_tool *tool)
{
	return cau_pose_is_same_place(&tool->state.pose, &tool->target) &&
	       cau_pose_is_same_turn(&tool->state.pose, &tool->target) &&
	       (tool->state.grasping || tool->jaw_target == tool->state.jaw);
}

void cau_session_hold_still(cau_session *session, const char *tool, uint64_t sequence)
{
	int32_t index = cau_session_find_tool(session, tool);
	take_out(session, tool, CAU_VOID_ALL);
	if (index < 0)
		return;
	cau_tool *held = &session->tool[index];
	if (!cau_session_stays(held))
		disturb(session);
	cau_session_stay(held);
	if (sequence)
		held->state.sequence = sequence;
}

// ---- which tools may heat

static bool is_among(const char *name, const char *const *names, int32_t count)
{
	for (int32_t i = 0; i < count; i++)
		if (strcmp(names[i], name) == 0)
			return true;
	return false;
}

const char *cau_session_heats_beyond(const cau_session *session, const char *const *allowed,
                                     int32_t count)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		if (session->tool[i].state.energized &&
		    !is_among(session->tool[i].state.name, allowed, count))
			return session->tool[i].state.name;
	for (int32_t k = 0; k < session->queue.count; k++)
		if (is_enable(&session->queue.command[k]) &&
		    !is_among(session->queue.command[k].tool, allowed, count))
			return session->queue.command[k].tool;
	return NULL;
}

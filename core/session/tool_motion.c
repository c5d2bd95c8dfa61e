// SPDX-License-Identifier: GPL-3.0-or-later
// Tools follow their drivers within their speed limits. A commanded pose that is far away is
// approached at the greatest speed, not reached at once.
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

int32_t cau_session_find_tool(const cau_session *session, const char *name)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		if (!strcmp(session->tool[i].state.name, name))
			return i;
	return -1;
}

cau_status cau_session_add_tool(cau_session *session, const cau_tool_def *def, cau_error *error)
{
	if (session->tool_count == CAU_MAX_TOOLS)
		return cau_fail(error, CAU_LIMIT, "tool", "a session has at most %d tools", CAU_MAX_TOOLS);
	if (cau_session_find_tool(session, def->name) >= 0)
		return cau_fail(error, CAU_ALREADY_EXISTS, "tool.name", "there is a tool \"%s\" already",
		                def->name);
	cau_tool *tool = &session->tool[session->tool_count];
	memset(tool, 0, sizeof *tool);
	cau_status status = cau_heat_grid_create(&tool->grid, def, session->scene->ambient_c,
	                                         session->solver.step_s, &def->pose, error);
	if (status)
		return status;
	memcpy(tool->state.name, def->name, sizeof tool->state.name);
	tool->state.definition = *def;
	tool->state.pose = tool->state.asked_pose = tool->anchor = def->pose;
	tool->target = tool->pose_before = tool->anchor_before = def->pose;
	tool->pace = 1;
	tool->blade = cau_session_blade_of(session, def);
	tool->state.jaw = tool->state.asked_jaw = tool->jaw_target = tool->jaw_before = 1;
	tool->state.tip_temperature_c = session->scene->ambient_c;
	session->tool_count++;
	return CAU_OK;
}

void cau_session_drop_tool(cau_session *session, int32_t index)
{
	CAU_ASSERT_INDEX(index, session->tool_count);
	cau_heat_grid_finish(&session->tool[index].grid);
	session->tool_count--;
	session->contact.sides.memory_count = 0; // the remembered faces refer to tools by index
	memmove(&session->tool[index], &session->tool[index + 1],
	        (size_t)(session->tool_count - index) * sizeof *session->tool);
}

// Returns the angle between two rotations, rad.
static double angle_between(const cau_pose *a, const cau_pose *b)
{
	double dot = 0;
	for (int i = 0; i < 4; i++)
		dot += a->rotation[i] * b->rotation[i];
	return 2 * acos(fmin(fabs(dot), 1));
}

static void move_tool(cau_session *session, cau_tool *tool)
{
	double dt = session->solver.step_s;
	CAU_ASSERT(dt > 0, "a tick of %g s", dt);
	const cau_tool_def *def = &tool->state.definition;
	cau_pose before = tool->state.asked_pose;
	double distance =
		cau_length(cau_sub(cau_vec3_of(tool->target.position_m), cau_vec3_of(before.position_m)));
	double angle = angle_between(&before, &tool->target);
	double share = 1;
	if (distance > def->max_speed_m_s * dt)
		share = fmin(share, def->max_speed_m_s * dt / distance);
	if (angle > def->max_turn_rad_s * dt)
		share = fmin(share, def->max_turn_rad_s * dt / angle);
	tool->state.asked_pose =
		share < 1 ? cau_pose_between(&before, &tool->target, share) : tool->target;
	tool->asked_before = before;
	tool->led = session->substep.part < 1
	                ? cau_pose_between(&before, &tool->state.asked_pose, session->substep.part)
	                : tool->state.asked_pose;
	cau_session_lead_tool(session, tool, &before);
	cau_session_turn_jaws(tool, dt, session->substep.part);
}

void cau_session_move_tools(cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		move_tool(session, &session->tool[i]);
}

void cau_session_lead_tools_on(cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool *tool = &session->tool[i];
		tool->tick_pose = tool->pose_before;
		tool->tick_jaw = tool->jaw_before;
		tool->led = tool->state.asked_pose;
		cau_session_lead_tool_on(session, tool);
		cau_session_turn_jaws(tool, session->solver.step_s, session->substep.part);
	}
}

void cau_session_keep_tick_poses(cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++) {
		session->tool[i].pose_before = session->tool[i].tick_pose;
		session->tool[i].jaw_before = session->tool[i].tick_jaw;
	}
}

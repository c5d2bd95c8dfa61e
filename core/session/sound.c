// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the invariants of tools, energy and waiting commands as a step begins, in every build. A
// violation is an error in this program, and a further step could heat tissue by mistake. So the
// step faults its session, only that session, and reports the finding.
#include <math.h>
#include <string.h>

#include "session/session_internal.h"

static cau_status unsound(cau_error *error, const char *tool, const char *what)
{
	return cau_fail(error, CAU_FAULTED, NULL,
	                "a safety rule was broken before the step: tool \"%.64s\" %s", tool, what);
}

static bool is_pose(const cau_pose *pose)
{
	double length2 = 0;
	for (int c = 0; c < 4; c++)
		length2 += pose->rotation[c] * pose->rotation[c];
	return isfinite(pose->position_m[0]) && isfinite(pose->position_m[1]) &&
	       isfinite(pose->position_m[2]) && length2 > 0.5 && length2 < 2;
}

static cau_status check_tool(const cau_tool *tool, cau_error *error)
{
	const cau_tool_state *state = &tool->state;
	const char *name = state->name;
	if (!memchr(name, 0, sizeof state->name) || !*name)
		return unsound(error, "", "has no name");
	if (state->definition.shape < 0 || state->definition.shape >= CAU_TOOL_SHAPE_COUNT)
		return unsound(error, name, "has a shape that does not exist");
	if (!is_pose(&state->pose) || !is_pose(&tool->target) || !is_pose(&tool->anchor))
		return unsound(error, name, "has a pose that is not finite");
	if (!(state->jaw >= 0) || !isfinite(state->jaw) || !isfinite(tool->jaw_target))
		return unsound(error, name, "has an opening of its jaws that is not finite");
	if (tool->grasp_count < 0 || tool->grasp_count > CAU_MAX_GRASPED)
		return unsound(error, name, "holds more points than jaws can");
	if (tool->grasp_count > 0 && !state->grasping)
		return unsound(error, name, "holds tissue with open jaws");
	if (!tool->grid.field[0].temperature)
		return unsound(error, name, "has no heat grid");
	return CAU_OK;
}

static cau_status check_names(const cau_session *session, cau_error *error)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		for (int32_t k = 0; k < i; k++)
			if (strcmp(session->tool[i].state.name, session->tool[k].state.name) == 0)
				return unsound(error, session->tool[i].state.name, "exists twice");
	return CAU_OK;
}

cau_status cau_session_check_sound(const cau_session *session, cau_error *error)
{
	cau_status status = CAU_OK;
	if (session->tool_count < 0 || session->tool_count > CAU_MAX_TOOLS)
		return unsound(error, "", "is beyond the largest number of tools");
	if (session->queue.count < 0 || session->queue.count > session->queue.capacity)
		return unsound(error, "", "has more waiting commands than the queue can hold");
	for (int32_t i = 0; i < session->tool_count && !status; i++)
		status = check_tool(&session->tool[i], error);
	return status ? status : check_names(session, error);
}

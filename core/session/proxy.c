// SPDX-License-Identifier: GPL-3.0-or-later
// A tool has a commanded pose and an actual pose. A driver leads the commanded pose within the
// tool's speed limits (tool_motion.c). The actual pose is coupled to the commanded pose by a spring
// (solve/answer.c). A tick begins with a guess of the actual pose, with which contacts are found.
// The solve then returns the actual pose.
//
// If a step cannot hold tissue that a tool would pass, the tool would move too far for one tick.
// Then the spring's anchor, which is normally at the commanded pose, stays behind, and the tick is
// solved again. The anchor follows in shorter motions, as far as the tissue yields. A tool that is
// too far behind its commanded pose jumps to it at once and releases its grasp. The tool then
// belongs on no side of the tissue that is around it.
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// Distance, m, to the commanded pose beyond which a tool jumps to that pose: ten times the spring's
// greatest extension.
static const double most_behind_m = 0.04;
// Factors on the share of its motion that a tool tries in a tick. A stop reduces the share to an
// eighth. Each tick without a stop doubles the share, so three ticks bring a tool back to full
// speed. The share never falls below least_pace, so a tool that is stopped again and again still
// moves.
static const double slower = 1.0 / 8, faster = 2, least_pace = 1.0 / 512;

static cau_vec3 offset_of(const cau_pose *pose, const cau_pose *anchor)
{
	return cau_sub(cau_vec3_of(pose->position_m), cau_vec3_of(anchor->position_m));
}

// Moves the anchor by a share of its motion, and the tool with it. A tool that pushes with its full
// force stays where it is.
static void lead(cau_tool *tool, double share)
{
	const double nearly_m = 0.9 * cau_coupling_reach_m;
	cau_tool_state *state = &tool->state;
	tool->anchor =
		share < 1 ? cau_pose_between(&tool->anchor_before, &tool->led, share) : tool->led;
	cau_vec3 offset = offset_of(&tool->pose_before, &tool->anchor_before);
	if (cau_length(offset) > nearly_m)
		offset = offset_of(&tool->pose_before, &tool->anchor);
	state->pose = cau_coupling_pose(&tool->anchor, offset);
}

static void let_go(cau_session *session, cau_tool *tool)
{
	cau_contact_forget(&session->contact, (int32_t)(tool - session->tool));
	tool->anchor_before = tool->pose_before = tool->led;
	tool->pace = 1;
	tool->grasp_count = 0;
	tool->state.slips++;
}

void cau_session_lead_tool(cau_session *session, cau_tool *tool, const cau_pose *asked_before)
{
	tool->anchor_before = tool->anchor;
	tool->pose_before = tool->state.pose;
	session->contact.tool[tool - session->tool].held_back = false;
	if (cau_length(offset_of(&tool->state.pose, asked_before)) > most_behind_m)
		let_go(session, tool);
	lead(tool, tool->pace);
}

void cau_session_lead_tool_on(cau_session *session, cau_tool *tool)
{
	tool->anchor_before = tool->anchor;
	tool->pose_before = tool->state.pose;
	session->contact.tool[tool - session->tool].held_back = false;
	lead(tool, tool->pace);
}

bool cau_session_hold_back(cau_session *session, int attempt)
{
	CAU_ASSERT_INDEX(attempt, CAU_ATTEMPTS + 1);
	bool any = false;
	for (int32_t i = 0; i < session->tool_count && attempt < CAU_ATTEMPTS; i++) {
		cau_tool *tool = &session->tool[i];
		if (!session->contact.tool[i].passing)
			continue;
		any = session->contact.tool[i].held_back = true;
		tool->pace = fmax(slower * tool->pace, least_pace);
		lead(tool, attempt == CAU_ATTEMPTS - 1 ? 0 : tool->pace);
	}
	// Supports stay where they are led. Frozen vertices return to the tick's start too: while the
	// freeze of a column is delayed, the step may have moved them.
	for (size_t v = 0; v < (size_t)session->tissue.vertex_count && any; v++)
		if (!session->vertices.pinned[v])
			memcpy(session->vertices.position + 3 * v, session->vertices.start + 3 * v,
			       3 * sizeof(double));
	return any;
}

void cau_session_let_follow(cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		if (!session->contact.tool[i].held_back)
			session->tool[i].pace = fmin(faster * session->tool[i].pace, 1);
}

void cau_session_couple(cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_contact_tool *tool = &session->contact.tool[i];
		tool->anchor = session->tool[i].anchor;
		cau_vec3_to(offset_of(&session->tool[i].state.pose, &tool->anchor), tool->offset);
	}
}

void cau_session_take_poses(cau_session *session)
{
	cau_contact_set *set = &session->contact;
	CAU_ASSERT(!session->tool_count || set->tool_count == session->tool_count, "%d tools of %d",
	           set->tool_count, session->tool_count);
	for (int32_t i = 0; i < session->tool_count; i++) {
		if (!set->row_count) // no contact constraint was solved that could hold the tool back
			memset(set->tool[i].offset, 0, sizeof set->tool[i].offset);
		session->tool[i].state.pose =
			cau_coupling_pose(&set->tool[i].anchor, cau_vec3_of(set->tool[i].offset));
	}
}

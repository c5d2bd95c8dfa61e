// SPDX-License-Identifier: GPL-3.0-or-later
// Tools in a snapshot: their state, what their poses hang on, what their jaws hold, their heat.
#include <stddef.h>

#include "cautery/assert.h"
#include "cautery/defaults.h"
#include "session/snapshot_archive.h"
#include "session/snapshot_header.h"

// What jaws press with came with version 8, in front of the pose.
void cau_snapshot_pass_tool_def(snapshot_archive *archive, cau_tool_def *def)
{
	const size_t force = offsetof(cau_tool_def, close_force_n), pose = offsetof(cau_tool_def, pose);
	_Static_assert(offsetof(cau_tool_def, pose) ==
	                   offsetof(cau_tool_def, close_force_n) + sizeof def->close_force_n,
	               "it is the last number of a tool");
	snapshot_pass(archive, def, force);
	if (archive->version >= CAU_SNAPSHOT_JAWS)
		snapshot_pass(archive, &def->close_force_n, sizeof def->close_force_n);
	else if (archive->reading) {
		cau_tool_def fresh;
		cau_default_tool_def(&fresh, def->shape);
		def->close_force_n = fresh.close_force_n;
	}
	snapshot_pass(archive, &def->pose, sizeof *def - pose);
}

void cau_snapshot_pass_tool_state(snapshot_archive *archive, cau_tool_state *state)
{
	const size_t before = offsetof(cau_tool_state, definition),
				 after = before + sizeof state->definition;
	snapshot_pass(archive, state, before);
	cau_snapshot_pass_tool_def(archive, &state->definition);
	snapshot_pass(archive, (char *)state + after, offsetof(cau_tool_state, asked_pose) - after);
}

// What came with version 8: before, jaws closed whole.
static void pass_pinch(snapshot_archive *archive, cau_tool *tool)
{
	cau_tool_state *state = &tool->state;
	if (archive->version >= CAU_SNAPSHOT_JAWS) {
		snapshot_pass(archive, &state->asked_jaw, sizeof state->asked_jaw);
		snapshot_pass(archive, &state->jaw_force_n, sizeof state->jaw_force_n);
		snapshot_pass(archive, &tool->least_open_rad, sizeof tool->least_open_rad);
	} else if (archive->reading) {
		state->asked_jaw = state->jaw;
	}
}

// What came with version 6: before, a tool was where it was asked to be.
static void pass_anchor(snapshot_archive *archive, cau_tool *tool)
{
	if (archive->version >= 6) {
		const size_t from = offsetof(cau_tool_state, asked_pose);
		snapshot_pass(archive, &tool->state.asked_pose, offsetof(cau_tool_state, asked_jaw) - from);
		snapshot_pass(archive, &tool->anchor, sizeof tool->anchor);
		snapshot_pass(archive, &tool->pace, sizeof tool->pace);
	} else if (archive->reading) {
		tool->state.asked_pose = tool->anchor = tool->state.pose;
		tool->pace = 1;
	}
}

// As it was when jaws held vertices alone; the faces come with pass_faces_held.
static void pass_hold(snapshot_archive *archive, cau_grasp *grasp)
{
	int32_t unused = 0;
	snapshot_pass(archive, &grasp->vertex[0], sizeof grasp->vertex[0]);
	snapshot_pass(archive, &unused, sizeof unused);
	snapshot_pass(archive, grasp->local, sizeof grasp->local);
	snapshot_pass(archive, grasp->start, sizeof grasp->start);
	if (archive->reading)
		*grasp = (cau_grasp){.face = -1,
		                     .vertex = {grasp->vertex[0], -1, -1},
		                     .weight = {1, 0, 0},
		                     .local = {grasp->local[0], grasp->local[1], grasp->local[2]},
		                     .start = {grasp->start[0], grasp->start[1], grasp->start[2]}};
}

void cau_snapshot_pass_tool(snapshot_archive *archive, cau_tool *tool)
{
	CAU_ASSERT(tool->grid.nodes >= 0 && tool->grid.nodes <= CAU_SNAPSHOT_NODES,
	           "a heat grid of %d nodes", tool->grid.nodes);
	cau_heat_grid *grid = &tool->grid;
	cau_snapshot_pass_tool_state(archive, &tool->state);
	snapshot_pass(archive, &tool->target, sizeof tool->target);
	snapshot_pass(archive, &tool->jaw_target, sizeof tool->jaw_target);
	snapshot_pass(archive, &tool->pose_before, sizeof tool->pose_before);
	pass_anchor(archive, tool);
	pass_pinch(archive, tool);
	snapshot_pass(archive, &tool->grasp_count, sizeof tool->grasp_count);
	for (int32_t k = 0; k < CAU_MAX_GRASPED; k++)
		pass_hold(archive, &tool->grasp[k]);
	snapshot_pass(archive, grid->field[0].origin, sizeof grid->field[0].origin);
	size_t nodes = (size_t)grid->nodes * (size_t)grid->nodes * (size_t)grid->nodes;
	int fields = archive->version < CAU_SNAPSHOT_NESTED ? 1 : CAU_HEAT_FIELDS;
	for (int k = 0; k < fields; k++)
		snapshot_pass(archive, grid->field[k].temperature, nodes * sizeof(float));
}

// Since version 6: which holds are on faces.
void cau_snapshot_pass_faces_held(snapshot_archive *archive, cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		for (int32_t k = 0; k < CAU_MAX_GRASPED; k++) {
			cau_grasp *grasp = &session->tool[i].grasp[k];
			snapshot_pass(archive, &grasp->face, sizeof grasp->face);
			snapshot_pass(archive, grasp->vertex, sizeof grasp->vertex);
			snapshot_pass(archive, grasp->weight, sizeof grasp->weight);
		}
}

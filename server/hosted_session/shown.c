// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/published.h"

#include <math.h>
#include <string.h>

#include "clock/clock.h"

// Largest distance between actual and commanded pose, m, that is not shown. A tool in contact is
// always a little behind its commanded pose, and a user does not see so small a distance.
static const double behind_m = 1e-5;

static bool is_behind(const cau_tool_state *tool)
{
	bool turned = false;
	double off2 = 0;
	for (int c = 0; c < 4; c++)
		turned |= tool->pose.rotation[c] != tool->asked_pose.rotation[c];
	for (int c = 0; c < 3; c++)
		off2 += pow(tool->pose.position_m[c] - tool->asked_pose.position_m[c], 2);
	return turned || off2 > behind_m * behind_m;
}

static void describe_tool(const cau_tool_state *from, cau_stream_tool *to)
{
	*to = (cau_stream_tool){
		.shape = from->definition.shape,
		.pose = from->pose,
		.behind = is_behind(from),
		.asked_pose = from->asked_pose,
		.jaw = from->jaw,
		.asked_jaw = from->asked_jaw,
		.jaw_force_n = from->jaw_force_n,
		.delivered_w = from->delivered_w,
		.load_ohm = from->load_ohm,
		.has_raw_force = true,
		.force_filter_s = from->definition.force_filter_s,
		.tip_temperature_c = from->tip_temperature_c,
		.energy_j = from->energy_j,
		.sequence = from->sequence,
		.energized = from->energized,
		.grasping = from->grasping,
		.slipping = from->slipping,
		.grasped_vertices = (uint16_t)fmin(from->grasped_vertices, UINT16_MAX),
		.contact_vertices = (uint16_t)fmin(from->contact_vertices, UINT16_MAX),
		.touched_layers = (uint16_t)from->touched_layers,
	};
	memcpy(to->name, from->name, sizeof to->name);
	memcpy(to->force_n, from->force_n, sizeof to->force_n);
	memcpy(to->torque_nm, from->torque_nm, sizeof to->torque_nm);
	memcpy(to->raw_force_n, from->raw_force_n, sizeof to->raw_force_n);
	memcpy(to->raw_torque_nm, from->raw_torque_nm, sizeof to->raw_torque_nm);
}

static void describe_step(const cau_statistics *from, cau_stream_statistics *to)
{
	*to = (cau_stream_statistics){
		.residual = (float)from->residual,
		.deferred_max_s = (float)from->deferred_max_s,
		.iterations = (uint32_t)from->iterations,
		.backtracks = (uint32_t)from->backtracks,
		.inverted = (uint32_t)from->inverted,
		.edges_parted = (uint32_t)from->edges_parted,
		.elements_removed = (uint32_t)from->elements_removed,
		.pending_downdates = (uint32_t)from->pending_downdates,
		.refactorisations = (uint32_t)from->refactorisations,
		.contacts = (uint32_t)from->contacts,
		.frozen_vertices = (uint32_t)from->frozen_vertices,
		.energy_gain_j = (float)from->energy_gain_j,
		.resting = from->resting,
		.error = (float)from->error,
		.contacts_left_out = (uint32_t)from->contacts_left_out,
		.elements_torn = (uint32_t)from->elements_torn,
		.touching_cut_short = (uint32_t)from->touching_cut_short,
	};
	for (int i = 0; i < CAU_STREAM_STAGES; i++)
		to->stage_s[i] = (float)from->seconds[i];
}

void cau_show(const cau_session *core, cau_shown *shown)
{
	cau_frame *frame = &shown->frame;
	cau_session_frame(core, frame);
	for (int32_t i = 0; i < frame->tool_count; i++)
		describe_tool(&frame->tools[i], &shown->tools[i]);
	describe_step(&frame->statistics, &shown->statistics);
	shown->sample = (cau_stream_sample){
		.tick = frame->tick,
		.time_s = frame->time_s,
		.published_us = (uint64_t)(cau_monotonic_s() * 1e6),
		.position = frame->position,
		.vertex_visible = frame->vertex_visible,
		.face_mask = frame->face_mask,
		.tool_count = frame->tool_count,
		.tools = shown->tools,
		.statistics = &shown->statistics,
		.vessel_count = frame->vessel_count,
		.vessels = frame->vessels,
		.contact_count = frame->contacts ? frame->tool_count : 0,
		.contacts = frame->contacts,
	};
	memcpy(shown->sample.scalar, frame->scalar, sizeof shown->sample.scalar);
}

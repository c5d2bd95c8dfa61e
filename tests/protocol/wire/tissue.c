// SPDX-License-Identifier: GPL-3.0-or-later
#include "protocol/wire/tissue.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WORD_FACES = 32 };

void tissue_init(tissue *made, int32_t columns, int32_t rows)
{
	int32_t vertices = columns * rows;
	int32_t faces = 2 * (columns - 1) * (rows - 1);
	*made = (tissue){
		.columns = columns,
		.rows = rows,
		.vertex_count = vertices,
		.face_count = faces,
		.position = calloc((size_t)vertices * 3, sizeof(double)),
		.visible = calloc((size_t)vertices, 1),
		.mask = calloc((size_t)(faces + WORD_FACES - 1) / WORD_FACES, sizeof(uint32_t)),
	};
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
		made->scalar[scalar] = calloc((size_t)vertices, sizeof(float));
	memset(made->visible, 1, (size_t)vertices);
	tissue_move(made, 0, 0.0);
}

void tissue_finish(tissue *made)
{
	free(made->position);
	free(made->visible);
	free(made->mask);
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
		free(made->scalar[scalar]);
	*made = (tissue){0};
}

static void move_vertex(tissue *moved, int32_t vertex, double time_s, double speed_m_s)
{
	int32_t column = vertex % moved->columns, row = vertex / moved->columns;
	double x = 0.002 * column, y = 0.002 * row;
	double turn = 6.283 * 0.7, reach = speed_m_s / turn, noise = 0.01 * reach;
	double *at = &moved->position[3 * (size_t)vertex];
	at[0] =
		x + reach * sin(turn * time_s + 20 * x + 9 * y) + noise * sin(100 * time_s + 37.7 * vertex);
	at[1] = y + reach * cos(turn * time_s + 14 * y);
	at[2] = reach * sin(turn * time_s + 250 * x * y + 30 * x) +
	        noise * sin(90 * time_s + 17.7 * vertex);
}

// Returns the body's temperature, or near the end of the cut the heat of a hook. The cut advances
// by one column a tick.
static float temperature_at(const tissue *of, int32_t vertex, int32_t tick)
{
	int32_t across = vertex / of->columns - of->rows / 2, along = vertex % of->columns - tick;
	int32_t squared = across * across + along * along;
	return squared < 9 ? 170.0f - 14.8f * (float)squared : 37.0f;
}

// Gives all scalars a wave within their ranges. Some scalars get other values later.
static void wave_scalars(tissue *moved, int32_t vertex, double time_s)
{
	cau_stream_def def = cau_default_stream_def();
	double steps = 100.0 + 50.0 * sin(time_s + 0.1 * vertex);
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		if (info->scalar >= 0)
			moved->scalar[info->scalar][vertex] =
				(float)(info->least + cau_channel_step(&def, (cau_channel_index)i) * steps);
	}
}

static void move_tool(cau_stream_tool *tool, const char *name, int shape, int32_t tick)
{
	*tool = (cau_stream_tool){
		.shape = shape,
		.pose = {.position_m = {0.0005 * tick, 0.01, 0.002}, .rotation = {1.0, 0.0, 0.0, 0.0}},
		.behind = tick % 3 == 1,
		.asked_pose = {.position_m = {0.0005 * tick, 0.01, 0.001},
	                   .rotation = {1.0, 0.0, 0.0, 0.0}},
		.jaw = 0.25,
		.asked_jaw = tick % 4 == 1 ? 0.0 : 0.25,
		.jaw_force_n = tick % 4 == 2 ? 4.5 : 0.0,
		.delivered_w = tick % 3 == 2 ? 27.5 : 0.0,
		.load_ohm = tick % 3 == 2 ? 640.0 : 0.0,
		.force_n = {0.1, -0.2, 0.0625 * (tick % 5)},
		.torque_nm = {0.0, 0.001, -0.002},
		.has_raw_force = tick % 5 != 4,
		.tip_temperature_c = 37.0 + tick,
		.energy_j = 0.5 * tick,
		.sequence = 1000u + (uint64_t)tick,
		.driver = 7,
		.energized = tick % 2 == 1,
		.energy_off = CAU_ENERGY_OFF_COMMANDED,
		.contact_vertices = 12,
		.touched_layers = 1,
	};
	strcpy(tool->name, name);
	if (!tool->has_raw_force)
		return;
	tool->force_filter_s = 0.02 * (tick % 3);
	for (int c = 0; c < 3; c++) {
		tool->raw_force_n[c] = 0.125 * (tick + c);
		tool->raw_torque_nm[c] = -0.0625 * (tick + c);
	}
}

static void move_vessel(cau_vessel_state *vessel, int32_t tick)
{
	*vessel = (cau_vessel_state){.name = "artery-1",
	                             .flags = (uint32_t)tick % (CAU_VESSEL_FLAGS + 1),
	                             .radius_m = 0.0015,
	                             .bleeding_m3_s = 1e-9 * tick,
	                             .shed_m3 = 1e-8 * tick,
	                             .burst_pa = 100.0 * tick,
	                             .point_count = 3 + tick % 2};
	for (int32_t i = 0; i < vessel->point_count; i++)
		vessel->point[i] = (cau_vessel_point){{0.001f * (float)i, 0.0001f * (float)tick, -0.002f},
		                                      i == 1 ? -1.0f : 0.5f};
}

static void move_contact(cau_tool_contact *contact, int32_t tick)
{
	*contact = (cau_tool_contact){
		.name = "hook",
		.valid = tick % 4 != 3,
		.time_s = tick / 60.0,
		.asked_pose = {.position_m = {0.5, 0.25, -0.125 * tick}, .rotation = {1, 0, 0, 0}},
		.pose = {.position_m = {0.5, 0.25, 0}, .rotation = {0.5, 0.5, 0.5, 0.5}},
		.force_n = {0.125, -0.25, 0.5 * tick},
		.plane_count = tick % 3,
		.compliance_m_n = {1, 2, 3, 0.125, 0.25, 0.5},
		.friction = 0.25,
		.damping_ns_m = 0.5,
		.grasp_n_m = tick % 2 ? 256 : 0,
		.grasp_anchor_m = {1, 2, 0.5 * tick},
	};
	for (int32_t i = 0; i < contact->plane_count; i++)
		contact->plane[i] = (cau_contact_plane){{0, i ? 1 : 0, i ? 0 : 1}, 0.25 * tick, -0.5 * i};
}

void tissue_move(tissue *moved, int32_t tick, double speed_m_s)
{
	double time_s = tick / 60.0;
	moved->tick = tick;
	for (int32_t vertex = 0; vertex < moved->vertex_count; vertex++) {
		move_vertex(moved, vertex, time_s, speed_m_s);
		wave_scalars(moved, vertex, time_s);
		bool near_cut =
			vertex / moved->columns == moved->rows / 2 && vertex % moved->columns < tick;
		moved->exposure[vertex] = near_cut ? 0.9f : 0.001f * (float)(tick % 100);
		moved->charring[vertex] = near_cut ? 0.5f : 0.0f;
		moved->stress[vertex] = (float)(1000.0 + 500.0 * sin(time_s + 0.1 * vertex));
		moved->temperature[vertex] = temperature_at(moved, vertex, tick);
	}
	int32_t row_faces = 2 * (moved->columns - 1), first = row_faces * (moved->rows / 2);
	for (int32_t face = first; face < first + tick && face < first + row_faces; face++)
		moved->mask[face / WORD_FACES] |= 1u << face % WORD_FACES;
	move_tool(&moved->tools[0], "hook", CAU_TOOL_HOOK, tick);
	move_vessel(&moved->vessel, tick);
	moved->vessels[0] = &moved->vessel;
	move_contact(&moved->contact, tick);
	move_tool(&moved->tools[1], "left-grasper", CAU_TOOL_GRASPER, tick);
	moved->statistics = (cau_stream_statistics){.realtime_factor = 1.0f,
	                                            .step_cost_s = 0.002f,
	                                            .stage_s = {0.25f, 0.5f},
	                                            .iterations = 10,
	                                            .contacts = (uint32_t)tick,
	                                            .energy_gain_j = 1e-6f * (float)tick,
	                                            .resting = tick % 2 != 0,
	                                            .error = 1e-4f * (float)tick,
	                                            .contacts_left_out = 2 * (uint32_t)tick,
	                                            .elements_torn = 3 * (uint32_t)tick,
	                                            .touching_cut_short = 5 * (uint32_t)tick};
}

cau_stream_def tissue_stream_def(const tissue *of)
{
	cau_stream_def def = cau_default_stream_def();
	def.session = 3;
	def.profile = 1;
	def.channels = CAU_CHANNEL_ALL;
	def.vertex_count = of->vertex_count;
	def.face_count = of->face_count;
	return def;
}

cau_stream_sample tissue_sample(const tissue *of)
{
	cau_stream_sample sample = {
		.tick = (uint64_t)of->tick,
		.time_s = of->tick / 60.0,
		.published_us = 1000000u + 16667u * (uint64_t)of->tick,
		.position = of->position,
		.vertex_visible = of->visible,
		.face_mask = of->mask,
		.tool_count = of->tick < 8 ? 1 : 2,
		.tools = of->tools,
		.statistics = &of->statistics,
		.vessel_count = of->tick < 8 ? 0 : 1,
		.vessels = of->vessels,
		.contact_count = of->tick < 8 ? 0 : 1,
		.contacts = &of->contact,
	};
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
		sample.scalar[scalar] = of->scalar[scalar];
	return sample;
}

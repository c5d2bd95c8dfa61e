// SPDX-License-Identifier: GPL-3.0-or-later
// A small scene in which all mechanisms act at once: fascia tied by links to a slab of fat with its
// membrane, built-in tension, plasticity, bending, shrinkage, random ignition temperatures, a hook
// that cuts faster than downdates can follow, a grasper that pulls, and rotating gravity.
#pragma once

#include "core/session/stage.h"

enum { BUSY_TICKS = 90 };

static inline void busy_heat(cau_heat_material *heat)
{
	heat->absorption_per_s = 8; // tissue parts within ticks instead of seconds
	heat->ignition_spread_c = 10;
}

static inline cau_scene_def *busy_scene(void)
{
	const double size[3] = {0.06, 0.03, 0.008};
	const int32_t cells[3] = {20, 10, 3};
	const double least[3] = {-0.1, -0.1, -0.0081}, most[3] = {0.1, 0.1, -0.0079};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_default_gravity(scene->gravity_m_s2);
	scene->seed = 7;
	cau_layer_def *fascia = stage_add_sheet(scene, "fascia", 0.06, 0.03, 24, 12);
	stage_mesh_of(scene, fascia)->translate_m[2] = 0.002;
	fascia->sheet[0].target[0] = fascia->sheet[0].target[1] = 0.4;
	fascia->sheet[0].shrink[0] = 0.3;
	fascia->sheet[0].bending_stiffness_nm = 1e-5;
	busy_heat(&fascia->sheet[0].heat);
	cau_layer_def *fat = stage_add_slab(scene, "fat", size, cells);
	fat->fat[0].limit = CAU_LIMIT_TARGET;
	fat->fat[0].target[0] = 0.7;
	fat->fat[0].shrink[0] = 0.3;
	fat->fat[0].yield_strain = 0.01;
	fat->fat[0].plastic_strain_max = 0.16;
	busy_heat(&fat->fat[0].heat);
	stage_add_membrane(scene, "membrane", "fat");
	busy_heat(&scene->layers[2].sheet[0].heat);
	busy_heat(&stage_add_links(scene, "links", "fascia", "membrane")->link.heat);
	cau_selection *rim = &scene->pins[scene->pin_count++];
	cau_default_selection(rim, CAU_SELECT_RIM);
	strcpy(rim->layer, "fascia");
	stage_pin_box(scene, least, most);
	stage_add_tool(scene, "hook", CAU_TOOL_HOOK, -0.025, 0, 0.03);
	stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.015, 0.004, 0.012);
	return scene;
}

// Makes all tissue able to tear. Tissue then tears also after the commands have ended, so only some
// tests call this function.
static inline void busy_tear(cau_scene_def *scene)
{
	const double tear_j_m2 = 50;
	for (int32_t i = 0; i < scene->layer_count; i++)
		scene->layers[i].sheet[0].heat.tear_energy_j_m2 =
			scene->layers[i].fat[0].heat.tear_energy_j_m2 =
				scene->layers[i].link.heat.tear_energy_j_m2 = tear_j_m2;
}

// Submits the commands of the next tick. They are the same for every session at the same tick.
static inline void busy_commands(cau_session *session)
{
	uint64_t tick = stage_frame(session).tick;
	double s = (double)tick / BUSY_TICKS;
	if (tick < 10)
		stage_move(session, "hook", -0.025, 0, 0.03 - 0.003 * (double)tick);
	else
		stage_move(session, "hook", -0.025 + 0.05 * s, 0.004 * sin(20 * s), 0.001);
	if (tick == 8)
		stage_energize(session, "hook", 1);
	if (tick < 8)
		stage_move(session, "jaws", 0.015, 0.004, 0.012 - 0.0018 * (double)tick);
	if (tick == 12)
		stage_grasp(session, "jaws");
	if (tick > 16)
		stage_move(session, "jaws", 0.015, 0.004 + 0.01 * s, -0.0024 + 0.02 * s);
	if (tick == 30)
		stage_gravity(session, 3, 0, -9);
	if (tick == 40)
		stage_force(session, stage_everything(), 0, 1e-4, 0);
}

static inline void busy_run(cau_session *session, int ticks)
{
	for (int k = 0; k < ticks; k++) {
		busy_commands(session);
		stage_step(session, 1);
	}
}

// SPDX-License-Identifier: Apache-2.0
// The tables of scenes and commands: what each JSON object may hold. Where members depend on a
// kind, the first field of the record is that kind.
#pragma once

#include "cautery/command.h"
#include "cautery/scene.h"
#include "json/record.h"

extern const cau_record cau_scene_record;           // cau_scene_def, without its arrays
extern const cau_record cau_mesh_record;            // cau_mesh_def, by source
extern const cau_record cau_layer_record;           // cau_layer_def without materials, by kind
extern const cau_record cau_region_record;          // int32_t: the region of a material
extern const cau_record cau_sheet_record;           // cau_sheet_material
extern const cau_record cau_fat_record;             // cau_fat_material
extern const cau_record cau_link_record;            // cau_link_material
extern const cau_record cau_heat_record;            // cau_heat_material
extern const cau_record cau_selection_record;       // cau_selection, by kind
extern const cau_record cau_tool_name_record;       // cau_tool_def's name
extern const cau_record cau_tool_record;            // cau_tool_def without name and pose
extern const cau_record cau_pose_record;            // cau_pose
extern const cau_record cau_vessel_record;          // cau_vessel_def without its points
extern const cau_record cau_vessel_point_record;    // double[3]: one of its points
extern const cau_record cau_pull_record;            // cau_pull_def without its selection
extern const cau_record cau_cut_record;             // cau_cut_def
extern const cau_record cau_command_record;         // cau_command without `as`, by kind
extern const cau_record cau_move_record;            // cau_command.as.move
extern const cau_record cau_energize_record;        // cau_command.as.energized
extern const cau_record cau_energize_limit_record;  // cau_command.as.ticks
extern const cau_record cau_material_record;        // cau_command.as.material without its materials
extern const cau_record cau_material_region_record; // int32_t: the region, 0 if absent
extern const cau_record cau_gravity_record;         // cau_command.as.gravity_m_s2
extern const cau_record cau_force_record;           // cau_command.as.force without its selection

// The parts of a material of a layer of that kind. Of the three structs the kind's own must be
// given.
int cau_material_parts(int layer_kind, cau_sheet_material *sheet, cau_fat_material *fat,
                       cau_link_material *link, cau_part parts[2]);

// All parts of a command: its head, then what its kind has. Of SET_MATERIAL, the material's kind
// must be set already.
int cau_command_parts(cau_command *command, cau_part parts[CAU_MAX_PARTS]);
// The same, without what older builds do not know and what says nothing: no limit of an enable.
int cau_command_parts_to_write(cau_command *command, cau_part parts[CAU_MAX_PARTS]);
// The selection of a command that has one, else NULL.
cau_selection *cau_command_selection(cau_command *command);

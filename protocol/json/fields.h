// SPDX-License-Identifier: Apache-2.0
// The tables of scenes and commands: which members each JSON object may have. If members depend on
// a kind, the record's first field is that kind. The comment at each table names the C type, or the
// member, that the table reads and writes.
#pragma once

#include "cautery/command.h"
#include "cautery/scene.h"
#include "json/record.h"

extern const cau_record cau_scene_record; // cau_scene_def, without its arrays
// cau_mesh_def; its members depend on the source
extern const cau_record cau_mesh_record;
// cau_layer_def without materials; its members depend on the kind
extern const cau_record cau_layer_record;
extern const cau_record cau_region_record;       // int32_t, the region of a material
extern const cau_record cau_sheet_record;        // cau_sheet_material
extern const cau_record cau_fat_record;          // cau_fat_material
extern const cau_record cau_link_record;         // cau_link_material
extern const cau_record cau_heat_record;         // cau_heat_material
extern const cau_record cau_selection_record;    // cau_selection; its members depend on the kind
extern const cau_record cau_tool_name_record;    // the name of cau_tool_def
extern const cau_record cau_tool_record;         // cau_tool_def without name and pose
extern const cau_record cau_pose_record;         // cau_pose
extern const cau_record cau_vessel_record;       // cau_vessel_def without its points
extern const cau_record cau_vessel_point_record; // double[3], one point of a vessel
extern const cau_record cau_pull_record;         // cau_pull_def without its selection
extern const cau_record cau_cut_record;          // cau_cut_def
// cau_command without `as`; its members depend on the kind
extern const cau_record cau_command_record;
extern const cau_record cau_move_record;            // cau_command.as.move
extern const cau_record cau_energize_record;        // cau_command.as.energized
extern const cau_record cau_energize_limit_record;  // cau_command.as.ticks
extern const cau_record cau_material_record;        // cau_command.as.material without its materials
extern const cau_record cau_material_region_record; // int32_t, the region; 0 if absent
extern const cau_record cau_gravity_record;         // cau_command.as.gravity_m_s2
extern const cau_record cau_force_record;           // cau_command.as.force without its selection

// Lists the parts of a material for a layer of kind `layer_kind`, and returns their number. Only
// the pointer that belongs to this kind must be given.
int cau_material_parts(int layer_kind, cau_sheet_material *sheet, cau_fat_material *fat,
                       cau_link_material *link, cau_part parts[2]);

// Lists all parts of a command and returns their number: its head, then the parts of its kind. For
// SET_MATERIAL, the material's kind must already be set.
int cau_command_parts(cau_command *command, cau_part parts[CAU_MAX_PARTS]);
// Lists the parts of a command to write. For an enable without a limit, the part with the limit is
// left out, because older builds do not know this part.
int cau_command_parts_to_write(cau_command *command, cau_part parts[CAU_MAX_PARTS]);
// Returns the selection of a command, or NULL if it has none.
cau_selection *cau_command_selection(cau_command *command);

// SPDX-License-Identifier: Apache-2.0
// Sets every member of a definition to its default. The defaults of scalars are in the tables of
// scene.h. All other defaults are here: vectors, choices, and values that depend on the kind of
// tissue. Core and protocol share these functions, so they are inline.
//
//     #include "cautery/defaults.h"
//
//     // A hook of 2 mm a centimetre above the tissue.
//     static cau_tool_def small_hook(void)
//     {
//         cau_tool_def tool;
//         cau_default_tool_def(&tool, CAU_TOOL_HOOK);
//         tool.hot_radius_m = 1e-3;
//         tool.pose.position_m[2] = 0.01;
//         return tool;
//     }
#pragma once

#include <string.h>

#include "cautery/command.h"
#include "cautery/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CAU_SET_DEFAULT(field, default_, least, most, unit, meaning) def->field = (default_);

// Sets gravity to 9.81 m/s^2 along -z.
static inline void cau_default_gravity(double gravity_m_s2[3])
{
	gravity_m_s2[0] = 0.0;
	gravity_m_s2[1] = 0.0;
	gravity_m_s2[2] = -9.81;
}

// Sets the identity rotation, with the tip 5 cm above the origin.
static inline void cau_default_pose(cau_pose *def)
{
	*def = (cau_pose){.position_m = {0.0, 0.0, 0.05}, .rotation = {1.0, 0.0, 0.0, 0.0}};
}

// Sets every member to its default for a selection of this kind, in any layer. The caller must set
// the position and size of a box, a sphere or a point.
static inline void cau_default_selection(cau_selection *def, int kind)
{
	memset(def, 0, sizeof *def);
	def->kind = kind;
}

// Returns the temperature (degC) at which the tissue of a kind of layer parts: fascia like
// peritoneum, membrane like mesentery, fat like liver (measured ignition temperatures, section
// 6.2). Links have the value of fascia.
static inline double cau_default_ignition_c(int layer_kind)
{
	switch (layer_kind) {
	case CAU_LAYER_MEMBRANE:
		return 96.4;
	case CAU_LAYER_FAT:
		return 76.0;
	default:
		return 172.0;
	}
}

// Sets every member to its default for this kind of layer.
static inline void cau_default_heat_material(cau_heat_material *def, int layer_kind)
{
	CAU_HEAT_TABLE(CAU_SET_DEFAULT)
	def->ignition_c = cau_default_ignition_c(layer_kind);
}

// Sets every member to its default. The strain limit is a target, equal to the rest shape, and heat
// does not shrink the sheet. `layer_kind`: CAU_LAYER_FASCIA or CAU_LAYER_MEMBRANE.
static inline void cau_default_sheet_material(cau_sheet_material *def, int layer_kind)
{
	memset(def, 0, sizeof *def);
	CAU_SHEET_TABLE(CAU_SET_DEFAULT)
	def->limit = CAU_LIMIT_TARGET;
	def->projection = CAU_PROJECTION_CLOSED_FORM;
	for (int i = 0; i < 2; i++) {
		def->target[i] = 1.0;
		def->strain_min[i] = -0.1;
		def->strain_max[i] = 0.1;
		def->shrink[i] = 1.0;
	}
	cau_default_heat_material(&def->heat, layer_kind);
}

// Sets every member to its default: stable neo-Hookean fat without limits, shrinkage and
// plasticity.
static inline void cau_default_fat_material(cau_fat_material *def)
{
	memset(def, 0, sizeof *def);
	CAU_FAT_TABLE(CAU_SET_DEFAULT)
	def->model = CAU_MODEL_NEOHOOKEAN;
	def->limit = CAU_LIMIT_NONE;
	def->projection = CAU_PROJECTION_CLOSED_FORM;
	for (int i = 0; i < 3; i++) {
		def->target[i] = 1.0;
		def->strain_min[i] = -0.1;
		def->strain_max[i] = 0.1;
		def->shrink[i] = 1.0;
	}
	cau_default_heat_material(&def->heat, CAU_LAYER_FAT);
}

// Sets every member to its default.
static inline void cau_default_link_material(cau_link_material *def)
{
	memset(def, 0, sizeof *def);
	CAU_LINK_TABLE(CAU_SET_DEFAULT)
	cau_default_heat_material(&def->heat, CAU_LAYER_LINKS);
}

// Sets every member to its default for a layer of this kind. The layer has one material, and its
// names are empty.
static inline void cau_default_layer_def(cau_layer_def *def, int kind)
{
	memset(def, 0, sizeof *def);
	def->kind = kind;
	def->tissue = kind == CAU_LAYER_FAT ? CAU_LIVING_FAT : CAU_LIVING_CONNECTIVE;
	def->perfusion = def->coagulated_tear = 1.0;
	def->fibre[0] = 1.0;
	def->material_count = 1;
	if (kind == CAU_LAYER_FAT)
		cau_default_fat_material(&def->fat[0]);
	else if (kind == CAU_LAYER_LINKS)
		cau_default_link_material(&def->link);
	else
		cau_default_sheet_material(&def->sheet[0], kind);
}

// Sets every member to its default: a generated sheet of 100 x 100 mm. The third extent, which a
// slab uses, is 10 mm.
static inline void cau_default_mesh_def(cau_mesh_def *def)
{
	memset(def, 0, sizeof *def);
	def->source = CAU_MESH_SHEET;
	def->size_m[0] = 0.1;
	def->size_m[1] = 0.1;
	def->size_m[2] = 0.01;
	def->cells[0] = 10;
	def->cells[1] = 10;
	def->cells[2] = 1;
	def->unit_m = 1.0;
}

// Sets every size and the pose to its default, with an empty name. `shape`: CAU_TOOL_*.
static inline void cau_default_tool_def(cau_tool_def *def, int shape)
{
	memset(def, 0, sizeof *def);
	def->shape = shape;
	CAU_TOOL_TABLE(CAU_SET_DEFAULT)
	cau_default_pose(&def->pose);
}

// Sets every size to its default, with empty names and no points.
static inline void cau_default_vessel_def(cau_vessel_def *def)
{
	memset(def, 0, sizeof *def);
	CAU_VESSEL_TABLE(CAU_SET_DEFAULT)
}

// Sets every member to its default. The pull is absent. If the caller sets `present`, the pull
// moves the vertices 25 mm up in half a second.
static inline void cau_default_pull_def(cau_pull_def *def)
{
	memset(def, 0, sizeof *def);
	def->move_m[2] = 0.025;
	def->duration_s = 0.5;
}

// Sets every member to its default. The cut is absent. If the caller sets `present`, the tool
// dwells for 3 s and moves at 2 mm/s.
static inline void cau_default_cut_def(cau_cut_def *def)
{
	memset(def, 0, sizeof *def);
	def->rotation[0] = 1.0;
	def->dwell_s = 3.0;
	def->speed_m_s = 0.002;
}

// Sets every member to its default. The scene has no meshes, layers, pins, tools or vessels, and
// pull and cut are absent.
static inline void cau_default_scene_def(cau_scene_def *def)
{
	memset(def, 0, sizeof *def);
	CAU_TIME_TABLE(CAU_SET_DEFAULT)
	def->iterations = 10;
	def->solver = CAU_SOLVER_CHOLESKY;
	def->precision = CAU_PRECISION_SINGLE;
	cau_default_gravity(def->gravity_m_s2);
	cau_default_pull_def(&def->pull);
	cau_default_cut_def(&def->cut);
}

// Sets every member to its default for a command of this kind, at the next tick. For SET_MATERIAL,
// `material.kind` is CAU_LAYER_FASCIA. The caller must set `material.kind` to the layer's kind, and
// fill the material of that kind.
static inline void cau_default_command(cau_command *def, int kind)
{
	memset(def, 0, sizeof *def);
	def->kind = kind;
	switch (kind) {
	case CAU_COMMAND_TOOL_ADD:
	case CAU_COMMAND_TOOL_CONFIGURE:
		cau_default_tool_def(&def->as.definition, CAU_TOOL_HOOK);
		break;
	case CAU_COMMAND_TOOL_MOVE:
		cau_default_pose(&def->as.move.pose);
		break;
	case CAU_COMMAND_SET_MATERIAL:
		def->as.material.kind = CAU_LAYER_FASCIA;
		cau_default_sheet_material(&def->as.material.sheet, CAU_LAYER_FASCIA);
		cau_default_fat_material(&def->as.material.fat);
		cau_default_link_material(&def->as.material.link);
		break;
	case CAU_COMMAND_SET_GRAVITY:
		cau_default_gravity(def->as.gravity_m_s2);
		break;
	default:
		break;
	}
}

#undef CAU_SET_DEFAULT

#ifdef __cplusplus
}
#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Commands that state a level: a tool's commanded pose, its energy, a material. A command that
// repeats the present level changes nothing. Drivers send levels repeatedly, and a lost connection
// may send a command twice. So a repeated level neither acts again nor wakes resting tissue.
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// ---- materials

// Sets a command's material in a layer's definition, or finds that the layer has this material
// already.

// Returns the index of the region's material; 0 (the default) if the region has no material of its
// own.
static int32_t find_material(const cau_layer_def *def, bool fat, int32_t region)
{
	CAU_ASSERT(def->material_count >= 1 && def->material_count <= CAU_MAX_MATERIALS, "%d materials",
	           def->material_count);
	for (int32_t m = 0; m < def->material_count; m++)
		if ((fat ? def->fat[m].region : def->sheet[m].region) == region)
			return m;
	return 0;
}

static bool fits(const cau_layer_def *def, const cau_command *command)
{
	bool fat = def->kind == CAU_LAYER_FAT, links = def->kind == CAU_LAYER_LINKS;
	int given = command->as.material.kind;
	return fat == (given == CAU_LAYER_FAT) && links == (given == CAU_LAYER_LINKS);
}

bool cau_layer_take_material(cau_layer_def *def, const cau_command *command)
{
	if (!fits(def, command))
		return false;
	if (def->kind == CAU_LAYER_FAT)
		def->fat[find_material(def, true, command->as.material.fat.region)] =
			command->as.material.fat;
	else if (def->kind == CAU_LAYER_LINKS)
		def->link = command->as.material.link;
	else
		def->sheet[find_material(def, false, command->as.material.sheet.region)] =
			command->as.material.sheet;
	return true;
}

// ---- whether the layer has the material already

// The comparison is field by field, because the padding bytes between fields may differ.

#define SAME(name, ...) &&a->name == b->name

static bool same_numbers(const double *a, const double *b, int count)
{
	for (int i = 0; i < count; i++)
		if (a[i] != b[i])
			return false;
	return true;
}

static bool same_heat(const cau_heat_material *a, const cau_heat_material *b)
{
	return true CAU_HEAT_TABLE(SAME);
}

static bool same_sheet(const cau_sheet_material *a, const cau_sheet_material *b)
{
	return a->region == b->region CAU_SHEET_TABLE(SAME) && a->limit == b->limit &&
	       a->projection == b->projection && same_numbers(a->target, b->target, 3) &&
	       same_numbers(a->strain_min, b->strain_min, 2) &&
	       same_numbers(a->strain_max, b->strain_max, 2) && same_numbers(a->shrink, b->shrink, 2) &&
	       same_heat(&a->heat, &b->heat);
}

static bool same_fat(const cau_fat_material *a, const cau_fat_material *b)
{
	return a->region == b->region CAU_FAT_TABLE(SAME) && a->model == b->model &&
	       a->limit == b->limit && a->projection == b->projection &&
	       same_numbers(a->target, b->target, 6) && same_numbers(a->strain_min, b->strain_min, 3) &&
	       same_numbers(a->strain_max, b->strain_max, 3) && same_numbers(a->shrink, b->shrink, 3) &&
	       same_heat(&a->heat, &b->heat);
}

static bool same_link(const cau_link_material *a, const cau_link_material *b)
{
	return true CAU_LINK_TABLE(SAME) && same_heat(&a->heat, &b->heat);
}

// Whether the command would change nothing in the layer.
static bool has_material(const cau_layer_def *def, const cau_command *command)
{
	if (!fits(def, command))
		return true;
	if (def->kind == CAU_LAYER_LINKS)
		return same_link(&def->link, &command->as.material.link);
	if (def->kind == CAU_LAYER_FAT) {
		const cau_fat_material *fat = &command->as.material.fat;
		return same_fat(&def->fat[find_material(def, true, fat->region)], fat);
	}
	const cau_sheet_material *sheet = &command->as.material.sheet;
	return same_sheet(&def->sheet[find_material(def, false, sheet->region)], sheet);
}

// ---- levels

bool cau_session_has_definition(const cau_tool *tool, const cau_tool_def *def)
{
	const cau_tool_def *now = &tool->state.definition;
	bool same = now->shape == def->shape;
#define COMPARE(field, ...) same = same && now->field == def->field;
	CAU_TOOL_TABLE(COMPARE)
#undef COMPARE
	return same;
}

static bool has_pose(const cau_session *session, const cau_tool *tool, const cau_command *command)
{
	const cau_pose *pose = &command->as.move.pose;
	CAU_ASSERT(session->tool_count > 0, "a move of %s, and no tool", command->tool);
	return cau_pose_is_same_place(pose, &tool->target) &&
	       cau_pose_is_same_turn(pose, &tool->target) &&
	       (tool->state.grasping || command->as.move.jaw == tool->jaw_target);
}

// A command for a tool that does not exist changes nothing, because it will be refused.
static bool has_tool_level(const cau_session *session, const cau_command *command)
{
	int32_t index = cau_session_find_tool(session, command->tool);
	if (index < 0)
		return true;
	const cau_tool *tool = &session->tool[index];
	switch (command->kind) {
	case CAU_COMMAND_TOOL_CONFIGURE:
		return cau_session_has_definition(tool, &command->as.definition);
	case CAU_COMMAND_TOOL_MOVE:
		return has_pose(session, tool, command);
	case CAU_COMMAND_TOOL_ENERGIZE:
		return tool->state.energized == (command->as.energized != 0);
	case CAU_COMMAND_TOOL_GRASP:
		return tool->state.grasping;
	case CAU_COMMAND_TOOL_RELEASE:
		return !tool->state.grasping && tool->jaw_target == 1;
	case CAU_COMMAND_TOOL_HOLD:
		return cau_session_stays(tool);
	default:
		return false;
	}
}

bool cau_session_has_material(const cau_session *session, const cau_command *command)
{
	int32_t index = cau_tissue_find_layer(&session->tissue, command->as.material.layer);
	return index < 0 || has_material(&session->tissue.layer[index].def, command);
}

static bool has_pins(cau_session *session, const cau_command *command)
{
	uint8_t pin = command->kind == CAU_COMMAND_PIN;
	size_t n = (size_t)session->tissue.vertex_count;
	memset(session->vertices.chosen, 0, n);
	cau_tissue_select(&session->tissue, &command->as.selection, session->vertices.chosen);
	for (size_t v = 0; v < n; v++)
		if (session->vertices.chosen[v] && session->vertices.pinned[v] != pin)
			return false;
	return true;
}

static bool has_force(cau_session *session, const cau_command *command)
{
	const double *force = command->as.force.force_n;
	size_t n = (size_t)session->tissue.vertex_count;
	memset(session->vertices.chosen, 0, n);
	cau_tissue_select(&session->tissue, &command->as.force.selection, session->vertices.chosen);
	for (size_t v = 0; v < n; v++)
		for (int c = 0; c < 3; c++)
			if (session->vertices.chosen[v] &&
			    session->vertices.external[3 * v + (size_t)c] != force[c])
				return false;
	return true;
}

static bool has_gravity(const cau_session *session, const cau_command *command)
{
	for (int c = 0; c < 3; c++)
		if (session->scene->gravity_m_s2[c] != command->as.gravity_m_s2[c])
			return false;
	return true;
}

bool cau_session_changes_nothing(cau_session *session, const cau_command *command)
{
	CAU_ASSERT_INDEX(command->kind, CAU_COMMAND_COUNT);
	switch (command->kind) {
	case CAU_COMMAND_TOOL_ADD:
		return cau_session_find_tool(session, command->as.definition.name) >= 0;
	case CAU_COMMAND_PIN:
	case CAU_COMMAND_UNPIN:
		return has_pins(session, command);
	case CAU_COMMAND_SET_MATERIAL:
		return cau_session_has_material(session, command);
	case CAU_COMMAND_SET_GRAVITY:
		return has_gravity(session, command);
	case CAU_COMMAND_SET_FORCE:
		return has_force(session, command);
	default:
		return has_tool_level(session, command);
	}
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/snapshot_state.h"

#include <string.h>

#include "cautery/assert.h"

// Ranges for members without a range in the scene's tables (scene.h). No member of the state
// exceeds them. Members with a range in the tables are also checked as those of scenes and
// commands, after reading.
static const double farthest_m = 1e6;  // m, distance of any point from the world's origin
static const double most_force = 1e12; // largest force, N, or torque, N m
static const double coldest_c = -1e4, warmest_c = 1e5;
// Largest distance of a heat grid's origin from the world's origin, in cells.
static const double most_cells = 1e10;
static const double most_turn = 100; // widest opening of jaws: rad, or a share

static void pass_any(snapshot_archive *archive, const char *what, double *value, size_t count)
{
	cau_snapshot_doubles(archive, what, value, count, -SNAPSHOT_ANY, SNAPSHOT_ANY);
}

static void pass_int(snapshot_archive *archive, const char *what, int32_t *value, int64_t least,
                     int64_t most)
{
	cau_snapshot_ints(archive, what, value, 1, least, most);
}

static void pass_choice(snapshot_archive *archive, const char *what, int *value, int count)
{
	int32_t choice = *value;
	pass_int(archive, what, &choice, 0, count - 1);
	*value = choice;
}

// Passes a member of a table with ranges (scene.h).
#define PASS_FIELD(field, default_, least, most, unit, meaning)                                    \
	cau_snapshot_doubles(archive, #field, &object->field, 1, least, most);

// ---- materials

static void pass_heat(snapshot_archive *archive, cau_heat_material *object)
{
	CAU_HEAT_TABLE(PASS_FIELD)
}

static void pass_sheet(snapshot_archive *archive, cau_sheet_material *object)
{
	pass_int(archive, "region", &object->region, INT32_MIN, INT32_MAX);
	CAU_SHEET_TABLE(PASS_FIELD)
	pass_choice(archive, "limit", &object->limit, CAU_LIMIT_COUNT);
	pass_choice(archive, "projection", &object->projection, CAU_PROJECTION_COUNT);
	pass_any(archive, "target", object->target, 3);
	pass_any(archive, "strain_min", object->strain_min, 2);
	pass_any(archive, "strain_max", object->strain_max, 2);
	pass_any(archive, "shrink", object->shrink, 2);
	pass_heat(archive, &object->heat);
}

static void pass_fat(snapshot_archive *archive, cau_fat_material *object)
{
	pass_int(archive, "region", &object->region, INT32_MIN, INT32_MAX);
	CAU_FAT_TABLE(PASS_FIELD)
	pass_choice(archive, "model", &object->model, CAU_MODEL_COUNT);
	pass_choice(archive, "limit", &object->limit, CAU_LIMIT_COUNT);
	pass_choice(archive, "projection", &object->projection, CAU_PROJECTION_COUNT);
	pass_any(archive, "target", object->target, 6);
	pass_any(archive, "strain_min", object->strain_min, 3);
	pass_any(archive, "strain_max", object->strain_max, 3);
	pass_any(archive, "shrink", object->shrink, 3);
	pass_heat(archive, &object->heat);
}

static void pass_link(snapshot_archive *archive, cau_link_material *object)
{
	CAU_LINK_TABLE(PASS_FIELD)
	pass_heat(archive, &object->heat);
}

void cau_snapshot_pass_layer(snapshot_archive *archive, cau_layer_def *layer)
{
	CAU_ASSERT(layer->material_count >= 1 && layer->material_count <= CAU_MAX_MATERIALS,
	           "%d materials", layer->material_count);
	for (int32_t m = 0; m < layer->material_count; m++)
		if (layer->kind == CAU_LAYER_FAT)
			pass_fat(archive, &layer->fat[m]);
		else if (layer->kind == CAU_LAYER_LINKS)
			pass_link(archive, &layer->link);
		else
			pass_sheet(archive, &layer->sheet[m]);
}

// ---- tools

static void pass_pose(snapshot_archive *archive, const char *what, cau_pose *pose)
{
	cau_snapshot_doubles(archive, what, pose->position_m, 3, -farthest_m, farthest_m);
	cau_snapshot_doubles(archive, what, pose->rotation, 4, -1.001, 1.001);
}

static void pass_definition(snapshot_archive *archive, cau_tool_def *object)
{
	cau_snapshot_text(archive, "name of a tool", object->name, sizeof object->name);
	pass_choice(archive, "shape", &object->shape, CAU_TOOL_SHAPE_COUNT);
	CAU_TOOL_TABLE(PASS_FIELD)
	pass_pose(archive, "first pose of a tool", &object->pose);
}

// Passes the tool's measurements of the last tick, which frames show.
static void pass_measured(snapshot_archive *archive, cau_tool_state *state)
{
	pass_int(archive, "contact_vertices", &state->contact_vertices, 0, INT32_MAX);
	pass_int(archive, "touched_layers", &state->touched_layers, 0, (1 << CAU_MAX_LAYERS) - 1);
	double *loads[] = {state->force_n, state->torque_nm, state->raw_force_n, state->raw_torque_nm};
	for (size_t i = 0; i < sizeof loads / sizeof *loads; i++)
		cau_snapshot_doubles(archive, "load on a tool", loads[i], 3, -most_force, most_force);
	cau_snapshot_doubles(archive, "jaw_force_n", &state->jaw_force_n, 1, -most_force, most_force);
	cau_snapshot_doubles(archive, "tip_temperature_c", &state->tip_temperature_c, 1, coldest_c,
	                     warmest_c);
	pass_any(archive, "energy_j", &state->energy_j, 1);
	pass_any(archive, "delivered_w", &state->delivered_w, 1);
	pass_any(archive, "load_ohm", &state->load_ohm, 1);
	pass_int(archive, "slips", &state->slips, 0, INT32_MAX / 2);
}

static void pass_state(snapshot_archive *archive, cau_tool_state *state)
{
	cau_snapshot_text(archive, "name of a tool", state->name, sizeof state->name);
	pass_definition(archive, &state->definition);
	pass_pose(archive, "pose", &state->pose);
	pass_pose(archive, "commanded pose", &state->asked_pose);
	cau_snapshot_doubles(archive, "jaw", &state->jaw, 1, 0, 1);
	cau_snapshot_doubles(archive, "commanded jaw", &state->asked_jaw, 1, 0, 1);
	cau_snapshot_bool(archive, "energized", &state->energized);
	cau_snapshot_bool(archive, "grasping", &state->grasping);
	cau_snapshot_bool(archive, "slipping", &state->slipping);
	cau_snapshot_words(archive, "sequence", &state->sequence, 1, UINT64_MAX);
	pass_measured(archive, state);
}

static void pass_grasp(snapshot_archive *archive, const cau_tissue *tissue, cau_grasp *grasp)
{
	pass_int(archive, "face in jaws", &grasp->face, -1, (int64_t)tissue->faces.face_count - 1);
	cau_snapshot_ints(archive, "vertex in jaws", grasp->vertex, 1, 0, tissue->vertex_count - 1);
	cau_snapshot_ints(archive, "vertex in jaws", grasp->vertex + 1, 2, -1,
	                  tissue->vertex_count - 1);
	cau_snapshot_doubles(archive, "weight in jaws", grasp->weight, 3, 0, 1);
	cau_snapshot_doubles(archive, "anchor in jaws", grasp->local, 3, -farthest_m, farthest_m);
	cau_snapshot_doubles(archive, "anchor in jaws", grasp->start, 3, -farthest_m, farthest_m);
}

void cau_snapshot_pass_tool(snapshot_archive *archive, const cau_session *session, cau_tool *tool)
{
	pass_state(archive, &tool->state);
	pass_pose(archive, "target of a tool", &tool->target);
	pass_pose(archive, "anchor of a tool", &tool->anchor);
	pass_pose(archive, "last pose of a tool", &tool->pose_before);
	cau_snapshot_doubles(archive, "target of jaws", &tool->jaw_target, 1, 0, 1);
	cau_snapshot_doubles(archive, "least opening of jaws", &tool->least_open_rad, 1, -most_turn,
	                     most_turn);
	cau_snapshot_doubles(archive, "pace of a tool", &tool->pace, 1, 0, 1);
	double blade_c = tool->blade.temperature_c;
	cau_snapshot_doubles(archive, "temperature of a blade", &blade_c, 1, coldest_c, warmest_c);
	if (archive->mode == SNAPSHOT_READ && !archive->wrong) {
		tool->blade = cau_session_blade_of(session, &tool->state.definition);
		tool->blade.temperature_c = blade_c;
	}
	pass_any(archive, "least load of a tool", &tool->least_ohm, 1);
	pass_int(archive, "points in jaws", &tool->grasp_count, 0, CAU_MAX_GRASPED);
	for (int32_t k = 0; k < tool->grasp_count && !archive->wrong; k++)
		pass_grasp(archive, &session->tissue, &tool->grasp[k]);
	tool->state.grasped_vertices = tool->grasp_count;
}

void cau_snapshot_pass_grid(snapshot_archive *archive, cau_heat_grid *grid)
{
	size_t nodes = (size_t)grid->nodes * (size_t)grid->nodes * (size_t)grid->nodes;
	cau_snapshot_longs(archive, "origin of a heat grid", grid->field[0].origin, 3,
	                   -(int64_t)most_cells, (int64_t)most_cells);
	for (int k = 0; k < CAU_HEAT_FIELDS; k++)
		cau_snapshot_floats(archive, "temperature", grid->field[k].temperature, nodes, coldest_c,
		                    warmest_c);
}

// ---- commands

static void pass_selection(snapshot_archive *archive, cau_selection *selection)
{
	pass_choice(archive, "select", &selection->kind, CAU_SELECT_COUNT);
	cau_snapshot_text(archive, "layer of a selection", selection->layer, sizeof selection->layer);
	pass_any(archive, "least_m", selection->least_m, 3);
	pass_any(archive, "most_m", selection->most_m, 3);
	pass_any(archive, "center_m", selection->center_m, 3);
	pass_any(archive, "radius_m", &selection->radius_m, 1);
}

static void pass_material_command(snapshot_archive *archive, cau_command *command)
{
	cau_snapshot_text(archive, "layer of a material", command->as.material.layer,
	                  sizeof command->as.material.layer);
	pass_int(archive, "kind of a material", &command->as.material.kind, 0, CAU_LAYER_COUNT - 1);
	if (archive->wrong)
		return;
	if (command->as.material.kind == CAU_LAYER_FAT)
		pass_fat(archive, &command->as.material.fat);
	else if (command->as.material.kind == CAU_LAYER_LINKS)
		pass_link(archive, &command->as.material.link);
	else
		pass_sheet(archive, &command->as.material.sheet);
}

static void pass_values(snapshot_archive *archive, cau_command *command)
{
	switch (command->kind) {
	case CAU_COMMAND_TOOL_ADD:
	case CAU_COMMAND_TOOL_CONFIGURE:
		pass_definition(archive, &command->as.definition);
		break;
	case CAU_COMMAND_TOOL_MOVE:
		pass_pose(archive, "pose", &command->as.move.pose);
		cau_snapshot_doubles(archive, "jaw", &command->as.move.jaw, 1, 0, 1);
		break;
	case CAU_COMMAND_TOOL_ENERGIZE:
		pass_int(archive, "energized", &command->as.energized, INT32_MIN, INT32_MAX);
		pass_int(archive, "ticks of energy", &command->as.ticks, 0, INT32_MAX);
		break;
	case CAU_COMMAND_PIN:
	case CAU_COMMAND_UNPIN:
		pass_selection(archive, &command->as.selection);
		break;
	case CAU_COMMAND_SET_MATERIAL:
		pass_material_command(archive, command);
		break;
	case CAU_COMMAND_SET_GRAVITY:
		pass_any(archive, "gravity_m_s2", command->as.gravity_m_s2, 3);
		break;
	case CAU_COMMAND_SET_FORCE:
		pass_selection(archive, &command->as.force.selection);
		pass_any(archive, "force_n", command->as.force.force_n, 3);
		break;
	default:
		break;
	}
}

void cau_snapshot_pass_command(snapshot_archive *archive, cau_command *command)
{
	pass_choice(archive, "kind of a command", &command->kind, CAU_COMMAND_COUNT);
	cau_snapshot_words(archive, "tick of a command", &command->tick, 1, UINT64_MAX);
	cau_snapshot_words(archive, "sequence of a command", &command->sequence, 1, UINT64_MAX);
	cau_snapshot_text(archive, "tool of a command", command->tool, sizeof command->tool);
	if (!archive->wrong)
		pass_values(archive, command);
}
